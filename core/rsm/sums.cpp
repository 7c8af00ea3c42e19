#include "rsm/sums.h"

#include "render/film.h"

#include <algorithm>
#include <cmath>

namespace ql {

PixelSumImage::PixelSumImage(int width, int height, uint32_t aovs)
    : m_width(width), m_height(height), m_aovs(aovs | kAovDirect | kAovIndirect) {
    const size_t pixels = size_t(width) * size_t(height);
    m_direct.resize(pixels, V3d(0));
    m_indirect.resize(pixels, V3d(0));
    m_passes.resize(pixels, 0);
    if (aovs & kAovVariance) m_squares.resize(pixels, V3d(0));
    if (aovs & kFirstHitAovs) m_first_hits.resize(pixels);
}

void PixelSumImage::add(int x, int y, const PixelPass& pass, const RenderSpace& space,
                        const PixelCamera& camera) {
    const size_t i = size_t(y) * size_t(m_width) + size_t(x);
    ++m_passes[i];
    m_direct[i] += V3d(pass.direct);
    m_indirect[i] += V3d(pass.indirect);
    if (!m_squares.empty()) {
        const V3d total = V3d(pass.direct) + V3d(pass.indirect);
        m_squares[i] += V3d(total.x * total.x, total.y * total.y, total.z * total.z);
    }
    if (m_first_hits.empty() || !pass.hit) return;
    FirstHits& first = m_first_hits[i];
    const V3d position = space.to_world(V3d(pass.position));
    ++first.hits;
    first.normal += V3d(pass.normal);
    first.albedo += V3d(pass.albedo);
    first.position += position;
    first.depth += camera.depth(position);
    first.id = pass.surface + 1;
}

Image PixelSumImage::image(int exponent) const {
    Film film(m_width, m_height, m_aovs);
    const double real = std::ldexp(1.0, exponent);
    for (int y = 0; y < m_height; ++y)
        for (int x = 0; x < m_width; ++x) {
            const size_t i = size_t(y) * size_t(m_width) + size_t(x);
            const double n = std::max(m_passes[i], 1);
            film.beauty.set(x, y, (m_direct[i] + m_indirect[i]) * (real / n));
            film.direct.set(x, y, m_direct[i] * (real / n));
            film.indirect.set(x, y, m_indirect[i] * (real / n));
            if (film.variance) {
                const V3d mean = (m_direct[i] + m_indirect[i]) / n;
                V3d variance(0);
                for (int c = 0; c < 3 && n > 1; ++c)
                    variance[c] = std::max(0.0, m_squares[i][c] / n - mean[c] * mean[c]) / (n - 1) *
                                  real * real;
                film.variance.set(x, y, variance);
            }
            if (m_first_hits.empty()) continue;
            const FirstHits& first = m_first_hits[i];
            const double hits = std::max(first.hits, 1);
            if (film.normal) film.normal.set(x, y, first.normal / hits);
            if (film.position) film.position.set(x, y, first.position / hits);
            if (film.albedo) film.albedo.set(x, y, first.albedo / hits);
            if (film.depth) (*film.depth)(x, y) = float(first.depth / hits);
            if (film.id) (*film.id)(x, y) = first.id;
        }
    return std::move(film.image);
}

} // namespace ql
