// Error by tile: where in a picture a method helps. The mean over a whole picture is decided by its
// few brightest errors; the distribution over tiles is not.
//
// Figures of a tile are means over its pixels, the channels and all frames added. The Gaussian of
// the perceptual error runs over the whole picture before it is cut, so tiles have no border of
// their own. A sample that is not finite counts as no error. Sums are in double in a fixed order.
#pragma once

#include "metrics/error.h"

#include <string>

namespace ql {

struct TileConfig {
    int tile_px = 16; // side of a tile, at least 1; cut at the right and lower border
    std::vector<double> sigmas_px = {1.0}; // of the perceptual errors, each in [0, 1000]
    Border border = Border::mirror;
};

struct TileFigures {
    int x = 0, y = 0, width = 0, height = 0; // pixels
    double mean_image = 0;
    double mean_reference = 0;
    double mse = 0;
    std::vector<double> perceptual; // in the order of sigmas_px
};

class TileErrors {
  public:
    // Errors: ErrorKind::usage for the config.
    TileErrors(const TileConfig& config, int width, int height);

    // One frame; all planes have the size given above.
    void add(std::span<const ChannelPair> channels, const Workers& workers);

    // Tiles by rows from the upper left corner. At least one frame has been added.
    std::vector<TileFigures> figures() const;

  private:
    struct TileSums {
        double image = 0, reference = 0;
        std::vector<double> squares; // mse, then one of each sigma
    };
    void add_squares(const Array2D<float>& error, size_t figure, const Workers& workers);

    TileConfig m_config;
    int m_width, m_height, m_columns, m_rows;
    int m_planes = 0; // added so far, over frames and channels
    std::vector<TileSums> m_sums;
};

// A header and a line each: x, y, width, height, means, mse and perceptual_Spx.
std::string tile_table(const std::vector<TileFigures>& tiles, const std::vector<double>& sigmas_px);

} // namespace ql
