#include "rsm/flux_table.h"

#include "base/check.h"

#include <algorithm>
#include <cmath>

namespace ql {

namespace {

// guide[k]: the first i with end[i] > k / n. The last end is 1.
template<class T, class Index>
void fill_guide(const T* end, size_t n, Index* guide) {
    size_t i = 0;
    for (size_t k = 0; k < n; ++k) {
        while (i + 1 < n && double(end[i]) * double(n) <= double(k))
            ++i;
        guide[k] = Index(i);
    }
}

// Turns weights into running sums that end at exactly 1 with the last weight above 0.
template<class T>
void accumulate(const std::vector<double>& weights, double sum, T* end) {
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

} // namespace

FluxTable::FluxTable(std::span<const ReflectiveShadowMap> maps) {
    if (maps.empty()) return;
    m_size = maps.front().size;
    const auto size = size_t(m_size);
    const size_t rows = maps.size() * size;
    m_texel_end.resize(rows * size);
    m_texel_guide.resize(rows * size);
    std::vector<double> row_flux(rows), flux(size);
    double all = 0;
    for (size_t row = 0; row < rows; ++row) {
        const ReflectiveShadowMap& map = maps[row / size];
        QL_CHECK_EQ(map.size, m_size);
        for (size_t x = 0; x < size; ++x) {
            const V3d f(map.texels.flux(row % size * size + x));
            flux[x] = f.x + f.y + f.z;
            row_flux[row] += flux[x];
        }
        all += row_flux[row];
        if (!(row_flux[row] > 0)) continue; // never chosen
        accumulate(flux, row_flux[row], &m_texel_end[row * size]);
        fill_guide(&m_texel_end[row * size], size, &m_texel_guide[row * size]);
    }
    const float inverse = all > 0 ? float(1 / all) : 0;
    if (!(inverse > 0) || !std::isfinite(inverse)) return;
    m_inverse_sum = inverse;
    m_row_end.resize(rows);
    m_row_guide.resize(rows);
    accumulate(row_flux, all, m_row_end.data());
    fill_guide(m_row_end.data(), rows, m_row_guide.data());
}

FluxTable::Choice FluxTable::sample(double u_row, float u_texel) const {
    const size_t rows = m_row_end.size();
    size_t row = m_row_guide[size_t(u_row * double(rows))];
    while (m_row_end[row] <= u_row)
        ++row;
    const double row_begin = row > 0 ? m_row_end[row - 1] : 0;
    const double y = (u_row - row_begin) / (m_row_end[row] - row_begin);

    const auto size = size_t(m_size);
    const float* end = &m_texel_end[row * size];
    // Rounding of the product may reach the next cell of the guide; step back then.
    size_t column = m_texel_guide[row * size + std::min(size_t(u_texel * float(size)), size - 1)];
    while (column > 0 && end[column - 1] > u_texel)
        --column;
    while (end[column] <= u_texel)
        ++column;
    const float column_begin = column > 0 ? end[column - 1] : 0;
    const float x = (u_texel - column_begin) / (end[column] - column_begin);
    return {row / size,
            row % size * size + column,
            {(float(column) + x) / float(m_size), (float(row % size) + float(y)) / float(m_size)}};
}

} // namespace ql
