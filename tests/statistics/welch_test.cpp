// Different ways to the same image: means of 8 x 8 tiles over independent renders must agree.
#include "metrics/statistics.h"
#include "reference/scene_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace ql {
namespace {

using namespace reference;

constexpr int kSide = 32;
constexpr int kTile = 8;
constexpr int kRenders = 12;
// For the whole suite: this many tiles are tested in about this many comparisons.
constexpr size_t kTests = 16 * (kSide / kTile) * (kSide / kTile);
constexpr double kLevel = 0.01;

using TileMeans = std::vector<std::vector<double>>; // by tile, one value per render

void add_tiles(const Image& image, TileMeans& tiles) {
    const int across = kSide / kTile;
    tiles.resize(size_t(across * across));
    for (int ty = 0; ty < across; ++ty)
        for (int tx = 0; tx < across; ++tx) {
            double sum = 0;
            for (int y = ty * kTile; y < (ty + 1) * kTile; ++y)
                for (int x = tx * kTile; x < (tx + 1) * kTile; ++x)
                    for (const char* channel : {"R", "G", "B"})
                        sum += double((*image.find(channel))(x, y));
            tiles[size_t(ty * across + tx)].push_back(sum / (3 * kTile * kTile));
        }
}

TileMeans tile_means(const Scene& scene, const RenderConfig& config, uint64_t first_seed) {
    TileMeans tiles;
    for (uint64_t i = 0; i < kRenders; ++i)
        add_tiles(render_scene(scene, cornell_view(kSide), config, first_seed + i).image, tiles);
    return tiles;
}

double least_p(const TileMeans& a, const TileMeans& b) {
    double least = 1;
    for (size_t i = 0; i < a.size(); ++i)
        least = std::min(least, welch_test(sample_moments(a[i]), sample_moments(b[i])).p_value);
    return least;
}

void expect_same(const TileMeans& a, const TileMeans& b) {
    EXPECT_GT(least_p(a, b), sidak_level(kLevel, kTests));
}

RenderConfig path_config(int spp, int max_depth, int roulette_depth, LightSampling sampling) {
    RenderConfig config;
    config.spp = spp;
    config.path.max_depth = max_depth;
    config.path.roulette_depth = roulette_depth;
    config.path.light_sampling = sampling;
    return config;
}

const Scene& diffuse_box() {
    static const Scene scene = cornell(lambert(V3f(0.9f)), emitter(V3f(12, 10, 8)));
    return scene;
}

TEST(Welch, SeesABiasOfFivePercent) {
    const RenderConfig config = path_config(16, 4, 0, LightSampling::mis);
    Scene brighter = diffuse_box();
    for (Material& material : brighter.materials)
        material.emission *= 1.05f;
    EXPECT_LT(least_p(tile_means(diffuse_box(), config, 0), tile_means(brighter, config, 100)),
              sidak_level(kLevel, kTests));
}

TEST(Welch, RouletteChangesNoMean) {
    for (const int max_depth : {2, 8})
        expect_same(
            tile_means(diffuse_box(), path_config(16, max_depth, 0, LightSampling::mis), 0),
            tile_means(diffuse_box(), path_config(16, max_depth, 1, LightSampling::mis), 100));
}

TEST(Welch, LightAndBsdfSamplingAgreeAtEveryDepth) {
    for (const int max_depth : {1, 2, 8}) {
        SCOPED_TRACE(max_depth);
        const TileMeans mis =
            tile_means(diffuse_box(), path_config(16, max_depth, 0, LightSampling::mis), 0);
        expect_same(mis, tile_means(diffuse_box(),
                                    path_config(16, max_depth, 0, LightSampling::lights), 100));
        expect_same(mis, tile_means(diffuse_box(),
                                    path_config(48, max_depth, 0, LightSampling::bsdf), 200));
    }
}

// Caustics of the area light through glass and off a narrow lobe.
TEST(Welch, LightAndBsdfSamplingAgreeOnGlassAndGlossySurfaces) {
    Material big_light = emitter(V3f(3));
    for (const Material& block : {glass(1.5f), glossy(V3f(0.3f), 0.6f, 40)}) {
        const Scene scene = cornell(block, big_light);
        expect_same(tile_means(scene, path_config(24, 6, 3, LightSampling::mis), 0),
                    tile_means(scene, path_config(48, 6, 3, LightSampling::bsdf), 100));
    }
    const Scene metals = cornell(metal(0.35f), big_light);
    const TileMeans mis = tile_means(metals, path_config(16, 4, 0, LightSampling::mis), 0);
    expect_same(mis, tile_means(metals, path_config(48, 4, 0, LightSampling::bsdf), 100));
    expect_same(mis, tile_means(metals, path_config(24, 4, 0, LightSampling::lights), 200));
}

// Two copies of a mesh are instances; the same triangles under two names are not.
TEST(Welch, InstancesLookLikeCopies) {
    const auto scene_with = [](bool shared) {
        SceneBuilder b;
        b.scene = cornell(lambert(V3f(0.5f)), emitter(V3f(12, 10, 8)));
        b.scene.meshes.push_back(sphere_mesh(12, 0));
        const int first = int(b.scene.meshes.size()) - 1;
        b.scene.meshes.push_back(b.scene.meshes.back());
        b.place_mesh(first, scaled({0.2, 0.1, 0.15}) * translated({0.1, 0.2, 0.1}));
        b.place_mesh(shared ? first : first + 1, scaled({-0.15, 0.2, 0.1}) *
                                                     rotated({0, 0, 1}, 0.5) *
                                                     translated({-0.25, 0.15, -0.2}));
        return b.scene;
    };
    const RenderConfig config = path_config(16, 4, 0, LightSampling::mis);
    expect_same(tile_means(scene_with(true), config, 0),
                tile_means(scene_with(false), config, 100));
}

// An emitter with a blended or cut-out surface: both strategies must see the holes.
TEST(Welch, LightAndBsdfSamplingAgreeOnEmittersWithAlpha) {
    Material light = emitter(V3f(12));
    light.alpha_mode = AlphaMode::blend;
    light.alpha = 0.4f;
    const Scene scene = cornell(lambert(V3f(0.5f)), light);
    expect_same(tile_means(scene, path_config(32, 2, 0, LightSampling::mis), 0),
                tile_means(scene, path_config(64, 2, 0, LightSampling::bsdf), 100));
}

// The image of two lights is the sum of the images of each.
TEST(Welch, LightsAdd) {
    const auto lit_by = [](bool area, bool point) {
        SceneBuilder b;
        b.scene = cornell(lambert(V3f(0.5f)), area ? emitter(V3f(12, 10, 8)) : lambert(V3f(0)));
        if (point) b.place_light(point_light(V3d(0.1, 0.2, 0.3)), translated({0.3, 0.2, 0.3}));
        return b.scene;
    };
    const RenderConfig config = path_config(64, 4, 3, LightSampling::mis);
    TileMeans sum = tile_means(lit_by(true, false), config, 0);
    const TileMeans second = tile_means(lit_by(false, true), config, 100);
    for (size_t tile = 0; tile < sum.size(); ++tile)
        for (size_t i = 0; i < sum[tile].size(); ++i)
            sum[tile][i] += second[tile][i];
    expect_same(sum, tile_means(lit_by(true, true), config, 200));
}

} // namespace
} // namespace ql
