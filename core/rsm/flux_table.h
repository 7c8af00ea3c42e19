// Points of all maps by their flux, from two numbers in [0, 1).
//
// By the inverse of the distribution function, rows first, then places in the row: unlike an alias
// table it is monotone, so that near numbers give near texels, which samples shifted by a
// blue-noise mask need. Guide tables make a look-up take constant time on average (Chen & Asau, "On
// generating random variates from an empirical distribution", 1974). Large maps are divided into
// cells of several texels, each with the flux of all of them, so that the tables stay in the
// cache: the density follows the flux cell by cell, which costs noise but no bias. Immutable.
#pragma once

#include "rsm/map.h"

#include <algorithm>
#include <span>

namespace ql {

class FluxTable {
  public:
    FluxTable() = default;
    explicit FluxTable(std::span<const ReflectiveShadowMap> maps);

    bool empty() const { return m_cell_share.empty(); }

    struct Choice {
        uint32_t map;
        V2f uv; // uniform in the cell
    };
    // The table must not be empty.
    Choice sample(double u_row, float u_place) const;

    // The same in steps, so that many samples wait for memory together: first row, which begins to
    // fetch what the next needs, then column, then choice. Rows are counted through all maps; the
    // column is the first that may be chosen.
    uint32_t row(double u_row, float u_place) const;
    uint32_t first_column(uint32_t row, float u_place) const {
        const uint32_t column = m_guide[guide_step(row, u_place)];
        __builtin_prefetch(&m_end[size_t(row) * size_t(m_cells) + column]);
        return column;
    }
    Choice choice(uint32_t row, uint32_t first_column, double u_row, float u_place) const;

    // Density at a point of a map, per area of the map's square; over all maps it sums to 1.
    float density(size_t map, const V2f& uv) const { return m_cell_share[cell_at(map, uv)]; }
    void prefetch_density(size_t map, const V2f& uv) const {
        __builtin_prefetch(&m_cell_share[cell_at(map, uv)]);
    }

  private:
    // Cells along a side; steps of the guide for a cell: more save steps of the search.
    static constexpr int kMostCells = 96;
    static constexpr int kSteps = 4;

    size_t guide_step(uint32_t row, float u_place) const {
        const int steps = m_cells * kSteps;
        return size_t(row) * size_t(steps) +
               size_t(std::min(int(u_place * float(steps)), steps - 1));
    }
    size_t cell_at(size_t map, const V2f& uv) const {
        const int x = std::min(int(uv.x * m_cells_per_side), m_cells - 1);
        const int y = std::min(int(uv.y * m_cells_per_side), m_cells - 1);
        return (map * size_t(m_cells) + size_t(y)) * size_t(m_cells) + size_t(x);
    }
    // Ends of a cell of a row or column, in map widths; the last one may be narrower.
    float cell_begin(uint32_t cell) const { return float(cell) / m_cells_per_side; }
    float cell_width(uint32_t cell) const {
        return std::min(1.0f, float(cell + 1) / m_cells_per_side) - cell_begin(cell);
    }

    int m_cells = 0;                   // along a side; all maps have the same
    float m_cells_per_side = 0;        // map width in cells, not whole where the last is narrower
    std::vector<double> m_row_end;     // sum of the shares up to and with each row
    std::vector<uint32_t> m_row_guide; // first row that may hold k / cells of the guide
    std::vector<float> m_end;          // the same within each row
    std::vector<uint8_t> m_guide;
    static_assert(kMostCells <= 256);
    std::vector<float> m_cell_share; // of all flux, over the cell's area in map areas
};

} // namespace ql
