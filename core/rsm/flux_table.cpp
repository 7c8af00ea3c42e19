#include "rsm/flux_table.h"

#include "base/check.h"

#include <cmath>

namespace ql {

namespace {

// guide[k]: the first i with end[i] > k / steps. The last end is 1.
template<class T, class Index>
void fill_guide(const T* end, size_t n, Index* guide, size_t steps) {
    size_t i = 0;
    for (size_t k = 0; k < steps; ++k) {
        while (i + 1 < n && double(end[i]) * double(steps) <= double(k))
            ++i;
        guide[k] = Index(i);
    }
}

// Turns weights into running sums that end at exactly 1 with the last weight above 0.
template<class T>
void accumulate(std::span<const double> weights, double sum, T* end) {
    double so_far = 0;
    size_t last = 0;
    for (size_t i = 0; i < weights.size(); ++i) {
        so_far += weights[i] / sum;
        end[i] = T(so_far);
        if (weights[i] > 0) last = i;
    }
    for (size_t i = 0; i < weights.size(); ++i)
        end[i] = i < last ? std::min(end[i], T(1)) : T(1);
}

// Flux of all colours in each cell of a map, row by row.
std::vector<double> cell_flux(const ReflectiveShadowMap& map, int cells, int texels_per_cell) {
    std::vector<double> flux(size_t(cells) * size_t(cells));
    for (int y = 0; y < map.size; ++y)
        for (int x = 0; x < map.size; ++x) {
            const V3d f(map.texels.flux(size_t(y) * size_t(map.size) + size_t(x)));
            flux[size_t(y / texels_per_cell) * size_t(cells) + size_t(x / texels_per_cell)] +=
                f.x + f.y + f.z;
        }
    return flux;
}

} // namespace

FluxTable::FluxTable(std::span<const ReflectiveShadowMap> maps) {
    if (maps.empty()) return;
    const int size = maps.front().size;
    const int texels_per_cell = (size + kMostCells - 1) / kMostCells;
    m_cells = (size + texels_per_cell - 1) / texels_per_cell;
    m_cells_per_side = float(size) / float(texels_per_cell);
    const auto cells = size_t(m_cells);
    const size_t rows = maps.size() * cells;
    m_end.resize(rows * cells);
    m_guide.resize(rows * cells * kSteps);
    std::vector<double> row_flux(rows), flux;
    double all = 0;
    for (const ReflectiveShadowMap& map : maps) {
        QL_CHECK_EQ(map.size, size);
        const std::vector<double> of_map = cell_flux(map, m_cells, texels_per_cell);
        flux.insert(flux.end(), of_map.begin(), of_map.end());
    }
    for (size_t row = 0; row < rows; ++row) {
        const std::span<const double> of_row(&flux[row * cells], cells);
        for (const double f : of_row)
            row_flux[row] += f;
        all += row_flux[row];
        if (!(row_flux[row] > 0)) continue; // never chosen
        accumulate(of_row, row_flux[row], &m_end[row * cells]);
        fill_guide(&m_end[row * cells], cells, &m_guide[row * cells * kSteps], cells * kSteps);
    }
    if (!(all > 0) || !(float(1 / all) > 0) || !std::isfinite(float(1 / all))) return;
    m_row_end.resize(rows);
    m_row_guide.resize(rows * kSteps);
    accumulate<double>(row_flux, all, m_row_end.data());
    fill_guide(m_row_end.data(), rows, m_row_guide.data(), m_row_guide.size());

    // Densities.
    m_cell_share.resize(flux.size());
    for (size_t i = 0; i < flux.size(); ++i) {
        const auto x = uint32_t(i % cells), y = uint32_t(i / cells % cells);
        m_cell_share[i] = float(flux[i] / all / double(cell_width(x)) / double(cell_width(y)));
    }
}

uint32_t FluxTable::row(double u_row, float u_place) const {
    // Rounding of the product may reach the next step of a guide; go back then.
    const size_t steps = m_row_guide.size();
    size_t row = m_row_guide[std::min(size_t(u_row * double(steps)), steps - 1)];
    while (row > 0 && m_row_end[row - 1] > u_row)
        --row;
    while (m_row_end[row] <= u_row)
        ++row;
    __builtin_prefetch(&m_guide[guide_step(uint32_t(row), u_place)]);
    return uint32_t(row);
}

FluxTable::Choice FluxTable::choice(uint32_t row, uint32_t first_column, double u_row,
                                    float u_place) const {
    const float* end = &m_end[size_t(row) * size_t(m_cells)];
    uint32_t column = first_column;
    while (column > 0 && end[column - 1] > u_place)
        --column;
    while (end[column] <= u_place)
        ++column;
    const float begin = column > 0 ? end[column - 1] : 0;
    const float x = (u_place - begin) / (end[column] - begin);
    const double row_begin = row > 0 ? m_row_end[row - 1] : 0;
    const auto y = float((u_row - row_begin) / (m_row_end[row] - row_begin));
    const uint32_t map = row / uint32_t(m_cells), row_in_map = row % uint32_t(m_cells);
    return {map,
            {cell_begin(column) + x * cell_width(column),
             cell_begin(row_in_map) + y * cell_width(row_in_map)}};
}

FluxTable::Choice FluxTable::sample(double u_row, float u_place) const {
    const uint32_t r = row(u_row, u_place);
    return choice(r, first_column(r, u_place), u_row, u_place);
}

} // namespace ql
