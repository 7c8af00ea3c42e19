#include "metrics/tiles.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace ql {
namespace {

Array2D<float> noise(int width, int height, unsigned seed) {
    Array2D<float> image(width, height);
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    for (float& value : image.values())
        value = normal(random);
    return image;
}

TEST(TileErrors, WeighedByTheirPixelsAreTheErrorOfThePicture) {
    const Array2D<float> image = noise(37, 21, 1), reference = noise(37, 21, 2);
    const ChannelPair pair{&image, &reference};
    const Workers workers(2);
    TileErrors tiles({.tile_px = 8, .sigmas_px = {1, 2.5}}, 37, 21);
    tiles.add(std::span(&pair, 1), workers);
    const ErrorFigures whole = error_figures(std::span(&pair, 1), {.sigmas_px = {1, 2.5}}, workers);
    double pixels = 0, mse = 0, mean = 0, perceptual[2] = {};
    for (const TileFigures& tile : tiles.figures()) {
        const double n = double(tile.width * tile.height);
        pixels += n;
        mse += n * tile.mse;
        mean += n * tile.mean_image;
        for (size_t s : {0u, 1u})
            perceptual[s] += n * tile.perceptual[s];
    }
    EXPECT_EQ(pixels, 37 * 21);
    EXPECT_NEAR(mse / pixels, whole.mse, 1e-7); // differences are rounded to float
    EXPECT_NEAR(mean / pixels, whole.mean_image, 1e-12);
    EXPECT_NEAR(perceptual[0] / pixels, whole.perceptual[0].mse, 1e-12);
    EXPECT_NEAR(perceptual[1] / pixels, whole.perceptual[1].mse, 1e-12);
}

TEST(TileErrors, SayWhereTheErrorIs) {
    Array2D<float> image(20, 10, 1.0f);
    const Array2D<float> reference(20, 10, 1.0f);
    image(17, 9) = 4;       // in the last, cut tile
    image(0, 0) = INFINITY; // left out
    const ChannelPair pair{&image, &reference};
    TileErrors tiles({.tile_px = 8, .sigmas_px = {}}, 20, 10);
    tiles.add(std::span(&pair, 1), Workers(1));
    const auto figures = tiles.figures();
    ASSERT_EQ(figures.size(), 6u);
    EXPECT_EQ(figures[5].x, 16);
    EXPECT_EQ(figures[5].y, 8);
    EXPECT_EQ(figures[5].width, 4);
    EXPECT_EQ(figures[5].height, 2);
    EXPECT_DOUBLE_EQ(figures[5].mse, 9.0 / 8);
    for (size_t i = 0; i < 5; ++i)
        EXPECT_EQ(figures[i].mse, 0);
}

TEST(TileErrors, AverageOverFrames) {
    const Array2D<float> reference(8, 8, 0.0f), one(8, 8, 1.0f), three(8, 8, 3.0f);
    TileErrors tiles({}, 8, 8);
    for (const Array2D<float>* frame : {&one, &three}) {
        const ChannelPair pair{frame, &reference};
        tiles.add(std::span(&pair, 1), Workers(1));
    }
    const auto figures = tiles.figures();
    ASSERT_EQ(figures.size(), 1u);
    EXPECT_DOUBLE_EQ(figures[0].mse, 5);
    EXPECT_DOUBLE_EQ(figures[0].mean_image, 2);
}

TEST(TileErrors, RefuseWhatMakesNoSense) {
    EXPECT_THROW(TileErrors({.tile_px = 0}, 8, 8), Error);
    EXPECT_THROW(TileErrors({.sigmas_px = {-1}}, 8, 8), Error);
}

} // namespace
} // namespace ql
