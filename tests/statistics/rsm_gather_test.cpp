// The gathers against the sum over all texels, and that sum against path tracing.
#include "bluenoise/mask.h"
#include "metrics/error.h"
#include "metrics/spectrum.h"
#include "metrics/statistics.h"
#include "statistics/rsm_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>

namespace ql {
namespace {

using namespace rsm_test;

constexpr double kAlpha = 1e-3;

Stage small_room(int side) {
    return Stage(spot_room(), side, {0.9, 0.8, 0.9}, {-0.3, -0.5, -0.3});
}

double block_relmse(const Image& image, const Image& reference) {
    std::vector<ChannelPair> pairs;
    for (const char* c : {"indirect.R", "indirect.G", "indirect.B"})
        pairs.push_back({image.find(c), reference.find(c)});
    return error_figures(pairs, {}, workers()).block_relmse;
}

// Means of red over passes, as estimates of the gather with every texel.
void expect_unbiased(const GatherConfig& config, int passes) {
    const Stage stage = small_room(6);
    const auto maps = stage.maps({.size = 24});
    GatherConfig full = config;
    full.gather = Gather::full;
    const Gatherer truth(stage.posed().rays(), maps, full);
    const Gatherer gatherer(stage.posed().rays(), maps, config);
    const std::vector<Receiver> receivers = stage.receivers();
    const double level = sidak_level(kAlpha, receivers.size());
    ShadowLog log;
    for (size_t i = 0; i < receivers.size(); ++i) {
        const V3f exact = truth.irradiance(receivers[i], {}, {}, 0, log);
        std::vector<double> values;
        for (int pass = 0; pass < passes; ++pass) {
            const ShiftSource shifts{Rotation::white, nullptr, 7};
            const PassSamples samples = config.gather == Gather::pattern
                                            ? pattern_samples(config.samples, 3, uint32_t(pass))
                                            : importance_samples(config.samples, 3, uint32_t(pass));
            values.push_back(double(gatherer
                                        .irradiance(receivers[i], samples,
                                                    shifts.place(int(i), 0, uint32_t(pass)), 0, log)
                                        .x));
        }
        const SampleMoments m = sample_moments(values);
        if (exact.x == 0) {
            EXPECT_EQ(m.mean, 0);
            continue;
        }
        const double error = std::sqrt(m.variance / double(m.count)) + 1e-6 * double(exact.x);
        EXPECT_GT(z_test(m.mean, double(exact.x), error).p_value, level) << "receiver " << i;
    }
}

TEST(RsmGather, ImportanceIsUnbiasedForTheMap) {
    expect_unbiased({.gather = Gather::importance, .samples = 8}, 1500);
}

TEST(RsmGather, APatternThatCoversTheMapIsUnbiased) {
    expect_unbiased({.gather = Gather::pattern, .samples = 32, .radius = 1.5f}, 1500);
}

TEST(RsmGather, ImportanceOfSeveralLightsIsUnbiased) {
    Builder b = spot_room();
    b.light(Light::Kind::point, {0.5, 0.5, 0.5}, {0, 0, -1}, 2);
    const Stage stage(b, 6, {0.9, 0.8, 0.9}, {-0.3, -0.5, -0.3});
    const auto maps = stage.maps({.size = 16});
    ASSERT_EQ(maps.size(), 2u);
    const Gatherer truth(stage.posed().rays(), maps, {.gather = Gather::full});
    const Gatherer gatherer(stage.posed().rays(), maps, {.samples = 64});
    double exact = 0, estimate = 0;
    ShadowLog log;
    for (const Receiver& r : stage.receivers()) {
        exact += double(truth.irradiance(r, {}, {}, 0, log).y);
        for (uint32_t pass = 0; pass < 64; ++pass)
            estimate +=
                double(gatherer.irradiance(r, importance_samples(64, 1, pass), {}, 0, log).y) / 64;
    }
    EXPECT_NEAR(estimate / exact, 1, 0.01);
}

TEST(RsmGather, ErrorOfImportanceFallsWithTheRootOfTheSamples) {
    const Stage stage = small_room(8);
    const auto maps = stage.maps({.size = 32});
    const Gatherer truth(stage.posed().rays(), maps, {.gather = Gather::full});
    const Gatherer gatherer(stage.posed().rays(), maps, {.samples = 4});
    constexpr int kReplicates = 6;
    const int passes[] = {4, 16, 64, 256};
    double squares[4] = {};
    ShadowLog log;
    const std::vector<Receiver> receivers = stage.receivers();
    for (size_t i = 0; i < receivers.size(); ++i) {
        const double exact = double(truth.irradiance(receivers[i], {}, {}, 0, log).y);
        for (int replicate = 0; replicate < kReplicates; ++replicate) {
            double sum = 0;
            for (int pass = 0, step = 0; step < 4; ++pass) {
                if (pass == passes[step]) squares[step++] += std::pow(sum / pass - exact, 2);
                const uint32_t number = uint32_t(replicate * 1000 + pass);
                const ShiftSource shifts{Rotation::white, nullptr, 5};
                sum += double(gatherer
                                  .irradiance(receivers[i], importance_samples(4, 3, number),
                                              shifts.place(int(i), 1, number), 0, log)
                                  .y);
            }
        }
    }
    // Least squares of log(rms) over log(passes), equally spaced.
    double slope = 0;
    for (int i = 0; i < 4; ++i)
        slope += (i - 1.5) * 0.5 * std::log(squares[i]) / (5 * std::log(4.0));
    EXPECT_NEAR(slope, -0.5, 0.05);
}

TEST(RsmGather, ErrorOfImportanceFallsAtLeastAsFastWithSamplesWithinAPass) {
    const Stage stage = small_room(8);
    const auto maps = stage.maps({.size = 32});
    const Gatherer truth(stage.posed().rays(), maps, {.gather = Gather::full});
    const std::vector<Receiver> receivers = stage.receivers();
    double rms[2] = {};
    ShadowLog log;
    for (int step = 0; step < 2; ++step) {
        const int samples = step == 0 ? 16 : 1024;
        const Gatherer gatherer(stage.posed().rays(), maps, {.samples = samples});
        for (const Receiver& r : receivers)
            for (uint32_t pass = 0; pass < 4; ++pass)
                rms[step] +=
                    std::pow(double((gatherer.irradiance(r, importance_samples(samples, 9, pass),
                                                         {}, 0, log) -
                                     truth.irradiance(r, {}, {}, 0, log))
                                        .y),
                             2);
    }
    EXPECT_LT(0.5 * std::log(rms[1] / rms[0]) / std::log(64.0), -0.45);
}

TEST(RsmGather, FullNearsPathTracingAsTheMapGrows) {
    const Stage stage(cornell_spot(), 32);
    const Image reference = stage.reference(1024);
    double before = 1;
    for (const int size : {12, 24, 48}) {
        const Image image = stage.render(config_of(Gather::full, size), 2);
        const double error = block_relmse(image, reference);
        EXPECT_LT(error, 0.75 * before) << size;
        before = error;
    }
    EXPECT_LT(before, 0.006);
}

// On the rear wall, seen through so narrow a camera that light hardly changes within a pixel: one
// pass will do.
TEST(RsmGather, FullAt512And1080HasTheMeanOfPathTracing) {
    const Stage stage(cornell_spot(), 4, {"", true, {0.278, 0.273, -0.8}, {0.2, 0.35, 0.55}, 2});
    const double traced = mean_of(stage.reference(32768), "indirect.");
    for (const int size : {512, 1080}) {
        const Image image = stage.render(config_of(Gather::full, size), 1);
        EXPECT_NEAR(mean_of(image, "indirect.") / traced, 1, 0.01) << size;
    }
}

// Means over tiles of 4 x 4 pixels of one rendering after the other.
std::vector<std::vector<double>> tile_means(int side, int count,
                                            const std::function<Image(int)>& render) {
    std::vector<std::vector<double>> tiles(size_t(side / 4 * side / 4));
    for (int i = 0; i < count; ++i) {
        const Image image = render(i);
        const Array2D<float>& green = *image.find("indirect.G");
        std::vector<double> sums(tiles.size());
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x)
                sums[size_t(y / 4 * (side / 4) + x / 4)] += double(green(x, y)) / 16;
        for (size_t t = 0; t < tiles.size(); ++t)
            tiles[t].push_back(sums[t]);
    }
    return tiles;
}

double least_p_value(const std::vector<std::vector<double>>& a,
                     const std::vector<std::vector<double>>& b) {
    double least = 1;
    for (size_t t = 0; t < a.size(); ++t)
        least = std::min(least, welch_test(sample_moments(a[t]), sample_moments(b[t])).p_value);
    return least;
}

// The camera looks into a corner of the room, where the bound takes most.
TEST(RsmGather, CompensationLeavesNoBiasAgainstPathTracing) {
    constexpr int kSide = 16, kRuns = 24;
    const Stage stage(spot_room(), kSide, {0.3, 0.2, 0.2}, {-0.6, -1, -1}, 60);
    const auto traced =
        tile_means(kSide, kRuns, [&](int i) { return stage.reference(256, uint64_t(i) + 50); });
    const auto gathered = [&](GeometryBound bound, Compensate compensate) {
        return tile_means(kSide, kRuns, [&, bound, compensate](int i) {
            RsmConfig config = config_of(Gather::importance, 12, 16);
            config.map.point = TexelPoint::jittered;
            config.gather.bound = bound;
            config.compensate = compensate;
            config.seed = uint64_t(i) + 1;
            return stage.render(config, 16);
        });
    };
    const double level = sidak_level(kAlpha, traced.size());
    EXPECT_GT(least_p_value(gathered({}, Compensate::yes), traced), level);
    EXPECT_GT(least_p_value(gathered({0, 0.04f}, Compensate::yes), traced), level);
    EXPECT_LT(least_p_value(gathered({}, Compensate::no), traced), level);
}

TEST(RsmGather, CompensationWorksForPerspectiveMapsAndEveryKindOfLight) {
    Builder b = spot_room();
    b.light(Light::Kind::point, {0.6, 0.5, -0.2}, {0, 0, -1}, 1);
    const Stage stage(b, 16, {0.3, 0.2, 0.2}, {-0.6, -1, -1}, 60);
    const double traced = mean_of(stage.reference(4096), "indirect.");
    for (const MapKind kind : {MapKind::equal_area, MapKind::perspective}) {
        RsmConfig config = config_of(Gather::importance, 16, 64);
        config.map.kind = kind;
        config.map.point = TexelPoint::jittered;
        config.compensate = Compensate::yes;
        EXPECT_NEAR(mean_of(stage.render(config, 96), "indirect.") / traced, 1, 0.01);
    }
}

TEST(RsmGather, DirectionalLightOnAnOpenSceneMatchesPathTracing) {
    Builder b;
    const int grey = b.material({0.5f, 0.6f, 0.7f});
    b.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, grey);
    b.quad({-1, 0, -1}, {2, 0, 0}, {0, 1.5, 0}, grey);
    b.light(Light::Kind::directional, {0, 0, 0}, {0.3, -1, -0.6}, 3);
    const Stage stage(b, 16, {0, 1, 2}, {0, 0.4, 0});
    RsmConfig config = config_of(Gather::importance, 32, 64);
    config.map.point = TexelPoint::jittered;
    config.compensate = Compensate::yes;
    EXPECT_NEAR(mean_of(stage.render(config, 512), "indirect.") /
                    mean_of(stage.reference(4096), "indirect."),
                1, 0.01);
}

Array2D<float> blue_mask(int side) {
    Progress progress;
    const Array2D<uint32_t> ranks = mask_ranks({.width = side, .height = side}, progress);
    Array2D<float> mask(side, side);
    for (size_t i = 0; i < ranks.size(); ++i)
        mask[i] = (float(ranks[i]) + 0.5f) / float(ranks.size());
    return mask;
}

// Errors of green against the gather with every texel, by rotation, one image for each seed.
struct RotationErrors {
    std::map<Rotation, std::vector<Array2D<float>>> differences;
    std::map<Rotation, double> perceptual; // summed over seeds, sigma 1 pixel
};
RotationErrors rotation_errors(Gather gather, int samples) {
    const Stage stage(cornell_spot(), 64);
    RsmConfig config = config_of(Gather::full, 48, samples);
    config.pixel = PixelPoint::centre;
    const Image exact = stage.render(config, 1);
    config.gather.gather = gather;
    config.gather.radius = gather == Gather::pattern ? 1.5f : 0.3f;
    config.mask = blue_mask(64);
    RotationErrors errors;
    for (config.seed = 0; config.seed < 16; ++config.seed)
        for (const Rotation rotation : {Rotation::none, Rotation::white, Rotation::blue}) {
            config.rotation = rotation;
            const Image image = stage.render(config, 1);
            const ChannelPair pair{image.find("indirect.G"), exact.find("indirect.G")};
            ErrorConfig perceptual;
            perceptual.sigmas_px = {1};
            errors.perceptual[rotation] +=
                error_figures(std::span(&pair, 1), perceptual, workers()).perceptual[0].mse;
            Array2D<float> difference(64, 64);
            for (size_t i = 0; i < difference.size(); ++i)
                difference[i] = (*pair.image)[i] - (*pair.reference)[i];
            errors.differences[rotation].push_back(difference);
        }
    return errors;
}

TEST(RsmGather, RotationTurnsBandsToNoiseAndAMaskMakesItBlue) {
    for (const Gather gather : {Gather::pattern, Gather::importance})
        for (const int samples : {16, 64}) {
            SCOPED_TRACE((gather == Gather::pattern ? "pattern " : "importance ") +
                         std::to_string(samples));
            RotationErrors errors = rotation_errors(gather, samples);
            EXPECT_LT(errors.perceptual[Rotation::white], 0.5 * errors.perceptual[Rotation::none]);
            // Single seeds may lose.
            EXPECT_LT(errors.perceptual[Rotation::blue], 0.9 * errors.perceptual[Rotation::white]);
            // Most of the error of bands is at low frequencies, little of that of blue noise.
            const auto low = [&](Rotation rotation) {
                return low_frequency_power(
                    mean_spectrum(errors.differences[rotation], Window::hann, workers()), 0.125);
            };
            EXPECT_GT(low(Rotation::none), 4);
            EXPECT_NEAR(low(Rotation::white), 1, 0.7);
            EXPECT_LT(low(Rotation::blue), 0.7 * low(Rotation::white));
        }
}

} // namespace
} // namespace ql
