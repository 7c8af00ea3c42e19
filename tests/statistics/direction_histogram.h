// Counts of directions against a density that is integrated over the same cells.
//
// Cells lie about an axis: rings of equal logarithmic width in the angle from it, so that lobes of
// any width fall into many cells, times equal steps of azimuth.
#pragma once

#include "metrics/statistics.h"
#include "sampling/warp.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace ql {

class DirectionHistogram {
  public:
    // smallest_angle (radians) bounds the innermost ring.
    DirectionHistogram(const V3f& axis, double smallest_angle)
        : m_frame(frame_from_normal(axis)), m_log_smallest(std::log(smallest_angle)) {}

    void add(const V3f& v) { ++m_counts[cell(v)]; }

    // Integral of the density over all cells, by the midpoint rule; fills in what is expected.
    double integrate(const std::function<double(const V3f&)>& pdf_solid_angle) {
        double total = 0;
        for (size_t ring = 0; ring < kRings; ++ring)
            for (size_t sector = 0; sector < kSectors; ++sector) {
                const double integral = cell_integral(pdf_solid_angle, ring, sector);
                m_integrals[ring * kSectors + sector] = integral;
                total += integral;
            }
        return total;
    }

    TestResult test(double count, double total) const {
        std::vector<double> expected = m_integrals;
        // A cell of which the midpoints miss a sliver is pooled, not forbidden.
        for (double& e : expected)
            e = std::max(e * count / total, 1e-3);
        return chi_square_test(m_counts, expected);
    }

  private:
    static constexpr size_t kRings = 16;
    static constexpr size_t kSectors = 16;
    static constexpr int kSteps = 32;

    double ring_edge(double ring) const { // angle at the inner edge
        if (ring <= 0) return 0;
        return std::exp(m_log_smallest + (std::log(M_PI) - m_log_smallest) * (ring - 1) /
                                             static_cast<double>(kRings - 1));
    }

    size_t cell(const V3f& world) const {
        // The angle from the chord, which is exact for small angles.
        const double chord = (world - m_frame.n).length();
        const double angle = 2 * std::asin(std::min(1.0, chord / 2));
        const double ring = (std::log(std::max(angle, 1e-30)) - m_log_smallest) /
                                (std::log(M_PI) - m_log_smallest) *
                                static_cast<double>(kRings - 1) +
                            1;
        const V3f v = m_frame.local_from_world(world);
        double turns = std::atan2(v.y, v.x) / (2 * M_PI);
        if (turns < 0) turns += 1;
        const auto r = static_cast<size_t>(std::clamp(ring, 0.0, double{kRings - 1}));
        const auto s = static_cast<size_t>(turns * double{kSectors});
        return r * kSectors + std::min(s, kSectors - 1);
    }

    double cell_integral(const std::function<double(const V3f&)>& pdf, size_t ring,
                         size_t sector) const {
        double sum = 0;
        const double low = ring_edge(static_cast<double>(ring));
        const double high = ring_edge(static_cast<double>(ring + 1));
        for (int i = 0; i < kSteps; ++i) {
            const double a = low + (high - low) * i / kSteps;
            const double b = low + (high - low) * (i + 1) / kSteps;
            // cos a - cos b without cancellation.
            const double band = 2 * std::sin((a + b) / 2) * std::sin((b - a) / 2);
            const double theta = (a + b) / 2;
            for (int j = 0; j < kSteps; ++j) {
                const double phi = 2 * M_PI * (static_cast<double>(sector) + (j + 0.5) / kSteps) /
                                   double{kSectors};
                const V3f local(static_cast<float>(std::sin(theta) * std::cos(phi)),
                                static_cast<float>(std::sin(theta) * std::sin(phi)),
                                static_cast<float>(std::cos(theta)));
                sum += band * pdf(m_frame.world_from_local(local));
            }
        }
        return sum * 2 * M_PI / double{kSectors} / kSteps;
    }

    Frame m_frame;
    double m_log_smallest;
    std::vector<uint64_t> m_counts = std::vector<uint64_t>(kRings * kSectors);
    std::vector<double> m_integrals = std::vector<double>(kRings * kSectors);
};

} // namespace ql
