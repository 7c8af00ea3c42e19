#include "metrics/tiles.h"

#include "base/check.h"
#include "base/error.h"

#include <algorithm>
#include <cmath>

namespace ql {

namespace {

// I and R where both are finite, zero elsewhere.
std::pair<float, float> comparable(const ChannelPair& channel, size_t i) {
    const float image = (*channel.image)[i], reference = (*channel.reference)[i];
    if (std::isfinite(image) && std::isfinite(reference)) return {image, reference};
    return {0.0f, 0.0f};
}

} // namespace

TileErrors::TileErrors(const TileConfig& config, int width, int height)
    : m_config(config), m_width(width), m_height(height) {
    if (config.tile_px < 1) throw usage_error("tile side {}, expected 1 or more", config.tile_px);
    for (const double sigma : config.sigmas_px)
        if (!(sigma >= 0 && sigma <= 1000))
            throw usage_error("sigma {} px, expected 0..1000", sigma);
    m_columns = (width - 1) / config.tile_px + 1;
    m_rows = (height - 1) / config.tile_px + 1;
    m_sums.resize(size_t(m_columns) * size_t(m_rows));
    for (TileSums& tile : m_sums)
        tile.squares.resize(1 + config.sigmas_px.size());
}

void TileErrors::add_squares(const Array2D<float>& error, size_t figure, const Workers& workers) {
    workers.for_each(size_t(m_rows), [&](size_t row) {
        const int y0 = int(row) * m_config.tile_px;
        const int y1 = std::min(y0 + m_config.tile_px, m_height);
        TileSums* tiles = &m_sums[row * size_t(m_columns)];
        for (int y = y0; y < y1; ++y)
            for (int x = 0; x < m_width; ++x)
                tiles[x / m_config.tile_px].squares[figure] +=
                    double(error(x, y)) * double(error(x, y));
    });
}

void TileErrors::add(std::span<const ChannelPair> channels, const Workers& workers) {
    for (const ChannelPair& channel : channels) {
        QL_CHECK_EQ(channel.image->width(), m_width);
        QL_CHECK_EQ(channel.image->height(), m_height);
        Array2D<float> error(m_width, m_height);
        for (int y = 0; y < m_height; ++y)
            for (int x = 0; x < m_width; ++x) {
                const size_t i = size_t(y) * size_t(m_width) + size_t(x);
                const auto [image, reference] = comparable(channel, i);
                TileSums& tile = m_sums[size_t(y / m_config.tile_px) * size_t(m_columns) +
                                        size_t(x / m_config.tile_px)];
                tile.image += double(image);
                tile.reference += double(reference);
                error[i] = image - reference;
            }
        add_squares(error, 0, workers);
        for (size_t s = 0; s < m_config.sigmas_px.size(); ++s)
            add_squares(
                filtered(error, gaussian_taps(m_config.sigmas_px[s]), m_config.border, workers),
                1 + s, workers);
        ++m_planes;
    }
}

std::vector<TileFigures> TileErrors::figures() const {
    QL_CHECK(m_planes > 0);
    std::vector<TileFigures> all;
    for (size_t i = 0; i < m_sums.size(); ++i) {
        const int x = int(i % size_t(m_columns)) * m_config.tile_px;
        const int y = int(i / size_t(m_columns)) * m_config.tile_px;
        TileFigures tile;
        tile.x = x;
        tile.y = y;
        tile.width = std::min(m_config.tile_px, m_width - x);
        tile.height = std::min(m_config.tile_px, m_height - y);
        const double n = double(tile.width) * tile.height * m_planes;
        tile.mean_image = m_sums[i].image / n;
        tile.mean_reference = m_sums[i].reference / n;
        tile.mse = m_sums[i].squares[0] / n;
        for (size_t s = 0; s < m_config.sigmas_px.size(); ++s)
            tile.perceptual.push_back(m_sums[i].squares[1 + s] / n);
        all.push_back(std::move(tile));
    }
    return all;
}

std::string tile_table(const std::vector<TileFigures>& tiles,
                       const std::vector<double>& sigmas_px) {
    std::string text = "x,y,width,height,mean_image,mean_reference,mse";
    for (const double sigma : sigmas_px)
        text += fmt::format(",perceptual_{}px", sigma);
    text += '\n';
    for (const TileFigures& tile : tiles) {
        text += fmt::format("{},{},{},{},{:.9g},{:.9g},{:.9g}", tile.x, tile.y, tile.width,
                            tile.height, tile.mean_image, tile.mean_reference, tile.mse);
        for (const double error : tile.perceptual)
            text += fmt::format(",{:.9g}", error);
        text += '\n';
    }
    return text;
}

} // namespace ql
