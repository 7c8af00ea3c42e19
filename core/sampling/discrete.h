// A choice among n items with given weights in constant time.
//
// Source: Vose, "A linear algorithm for generating random numbers with a given distribution", IEEE
// Trans. Softw. Eng. 17 (1991). Built in double precision: any range of weights may meet in one
// table, but those below 2^-53 of the mean are never chosen: no random double would hit them. The
// same weights give the same table. Immutable, hence safe to share between threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ql {

struct DiscreteSample {
    uint32_t index;
    float probability; // of that index
    float u;           // in [0, 1): what is left of the random number, uniform again
};

class AliasTable {
  public:
    AliasTable() = default;
    // Weights that are zero, negative or not finite are never chosen. If none is left the table is
    // empty. At most 2^32 - 1 weights.
    explicit AliasTable(std::span<const double> weights);

    bool empty() const { return m_slots.empty(); }
    size_t size() const { return m_slots.size(); }
    double sum() const { return m_sum; } // of the weights
    // Nothing is ever drawn from an empty table.
    float probability(size_t index) const { return empty() ? 0 : m_slots[index].probability; }

    // u in [0, 1); the table must not be empty. A float has bits for some 1e4 items; for more, use
    // unit_double.
    DiscreteSample sample(double u) const {
        const double scaled = u * static_cast<double>(m_slots.size());
        const auto slot = static_cast<uint32_t>(scaled);
        const double rest = scaled - slot;
        const Slot& s = m_slots[slot];
        const bool own = rest < s.threshold;
        const double left = own ? rest / s.threshold : (rest - s.threshold) / (1.0 - s.threshold);
        const uint32_t index = own ? slot : s.alias;
        const float u_left = static_cast<float>(left);
        return {index, m_slots[index].probability, u_left < 1 ? u_left : 0x1.fffffep-1f};
    }

  private:
    struct Slot {
        double threshold;  // below it the slot's own index, else its alias
        float probability; // of the slot's own index, over all slots
        uint32_t alias;
    };
    std::vector<Slot> m_slots;
    double m_sum = 0;
};

} // namespace ql
