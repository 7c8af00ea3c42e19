// The energy estimator against closed forms and against path tracing.
#include "linespace/inject.h"
#include "linespace/sample.h"
#include "reference/linespace_scenes.h"
#include "render/path_tracer.h"
#include "sampling/seeds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace ql {
namespace {

using reference::BoxScene;

const Workers kWorkers(2);

struct Posed {
    Scene scene;
    RenderSpace space;
    PosedScene posed;
    explicit Posed(Scene s)
        : scene(std::move(s)), space(render_space_of(scene, kWorkers)),
          posed(scene, space, 0, kWorkers) {}
};

LightCache inject(const Posed& p, const InjectConfig& config) {
    Progress progress;
    InjectReport report;
    return ql::inject(p.posed, 1, config, kWorkers, progress, report);
}

// Inside the box, looking from one upper edge to the floor.
PixelCamera camera_of(const Posed& p, double size, int pixels) {
    CameraChoice choice;
    choice.explicit_view = true;
    choice.look_from = V3d(0.5, 0.7, 0.97) * size;
    choice.look_at = V3d(0.45, 0.25, 0) * size;
    choice.fov_degrees = 75;
    const ChosenCamera chosen = choose_camera(p.scene, p.space, choice);
    return pixel_camera(chosen, p.scene, p.space, 0, pixels, pixels);
}

constexpr int kPixels = 20;

double mean_of(const Image& image, const char* layer) {
    double sum = 0;
    for (const char* c : {".R", ".G", ".B"})
        for (const float value : image.find(std::string(layer) + c)->values())
            sum += double(value);
    return sum / (3 * kPixels * kPixels);
}

Image path_traced(const Posed& p, double size, int depth, int spp) {
    Progress progress;
    RenderConfig config;
    config.path.max_depth = depth;
    config.path.roulette_depth = 0;
    config.spp = spp;
    config.aovs = kAovIndirect | kAovDirect;
    return render_frame(p.posed, camera_of(p, size, kPixels), fresh_seeds(3, 0, kPixels, kPixels),
                        config, nullptr, kWorkers, progress)
        .image;
}

Image cache_sampled(const Posed& p, const LightCache& cache, double size, int spp,
                    ReadConfig read = {}, double smoothing = 0) {
    Progress progress;
    const ReadTable table(cache, p.space, p.posed.lights(), {smoothing}, kWorkers);
    SampleConfig config;
    config.read = read;
    config.read.max_depth = cache.header.max_depth;
    config.read.roulette_depth = 0;
    config.read.reads = 4;
    config.spp = spp;
    config.layers = kLayerDirect | kLayerIndirect | kLayerCached;
    config.blur_metres = cache.header.blur;
    const OpenSides sides(p.posed.rays(), LightEmission(p.posed.lights()), kWorkers);
    return sample_frame(p.posed, camera_of(p, size, kPixels), table, nullptr, &sides,
                        fresh_seeds(4, 0, kPixels, kPixels), config, kWorkers, progress)
        .image;
}

InjectConfig injection(int voxels, int patches, uint64_t photons, int depth) {
    InjectConfig config;
    config.grid.voxels = {voxels, voxels, voxels};
    config.patches = patches;
    config.photons = {0, photons};
    config.max_depth = depth;
    return config;
}

double indirect_ratio(const Posed& p, const InjectConfig& config, double expected,
                      double smoothing = 0) {
    return mean_of(cache_sampled(p, inject(p, config), 1, 48, {}, smoothing), "indirect") /
           expected;
}

double path_traced_indirect(const Posed& p, int depth) {
    return mean_of(path_traced(p, 1, depth, 300), "indirect"); // known to 0.1 %
}

TEST(LinespaceEnergy, OfAFurnaceIsTheClosedForm) {
    // Walls that emit 1 and reflect a half: what arrives after one scattering or more is 1.
    const Posed p(reference::box_scene({.albedo = 0.5f, .emission = V3f(1)}));
    for (const double blur : {0.0, 0.5}) {
        InjectConfig config = injection(6, 2, 600000, 40);
        config.blur = {blur, true};
        const LightCache cache = inject(p, config);
        const ReadTable table(cache, p.space, p.posed.lights(), {}, kWorkers);
        double light = 0, measure = 0;
        for (uint32_t v = 0; v < cache.header.voxel_count(); ++v)
            for (uint64_t i = cache.first[v]; i < cache.first[v + 1]; ++i) {
                const V3f radiance = table.radiance(v, cache.shafts[i]);
                const double m = double(cache.measures[i]);
                light += double(radiance.x) * m * std::ldexp(1.0, p.posed.lights().exponent());
            }
        // The measure of a voxel counts its dark shafts too. Both sides of the walls shine, and the
        // outside reflects nothing back: photons that start outside leave, that side is closed.
        const ShaftGroups groups(cache.header.patches, cache.header.normal_classes);
        for (size_t g = 0; g < cache.groups.size(); ++g)
            if (groups.is_voxel(cache.groups[g])) measure += double(cache.group_measures[g]);
        EXPECT_NEAR(light / measure, 1, 0.01) << blur;
    }
}

TEST(LinespaceEnergy, StoredAndGatedLightIsTheClosedForm) {
    // A closed box of albedo rho receives Phi rho / (1 - rho) after the first scattering.
    const Posed p(reference::box_scene({.albedo = 0.5f, .lights = {{{0.5, 0.6, 0.5}, 1}}}));
    InjectConfig config = injection(200, 1, 60000, 40);
    // Nobody asks for the measures of so many voxels here.
    config.measure.max_lines = config.measure.max_voxel_lines = 32;
    const LightCache cache = inject(p, config);
    double stored = 0;
    for (const int64_t weight : cache.header.weight_by_order)
        stored += double(weight) / (1 << kOrderBits);
    EXPECT_NEAR(stored / 60000, 1, 0.015);
    EXPECT_NEAR(cache.header.unit, 4 * std::numbers::pi, 1e-4);
}

TEST(LinespaceEnergy, MeanOfIndirectLightIsThatOfPathTracing) {
    const BoxScene::PointLight lights[] = {
        {{0.5, 0.8, 0.5}, 1}, {{0.2, 0.5, 0.3}, 0.4}, {{0.8, 0.3, 0.7}, 0.2}};
    for (size_t count = 1; count <= 3; ++count) {
        BoxScene box{.albedo = 0.7f, .left = V3f(0.6f, 0.1f, 0.1f)};
        box.lights.assign(lights, lights + count);
        const Posed p(reference::box_scene(box));
        const double expected = path_traced_indirect(p, 6);
        const int voxels = count == 1 ? 12 : count == 2 ? 25 : 6;
        EXPECT_NEAR(indirect_ratio(p, injection(voxels, 4, 400000, 6), expected), 1, 0.015)
            << voxels << " voxels, " << count << " lights";
    }
}

TEST(LinespaceEnergy, OfALampThatIsASphereIsThatOfPathTracing) {
    const Posed p(reference::box_scene({.albedo = 0.7f, .lamp_radius = 0.1f}));
    const double expected = path_traced_indirect(p, 6);
    EXPECT_NEAR(indirect_ratio(p, injection(12, 4, 400000, 6), expected), 1, 0.015);
}

TEST(LinespaceEnergy, DoesNotDependOnHowPhotonsAreSplit) {
    const Posed p(reference::box_scene({.albedo = 0.5f, .lights = {{{0.5, 0.6, 0.5}, 1}}}));
    InjectConfig config = injection(6, 2, 100000, 6);
    config.branches = 1;
    const LightCache whole = inject(p, config);
    config.branches = 16;
    const LightCache split = inject(p, config);
    for (size_t order = 0; order < whole.header.weight_by_order.size(); ++order)
        EXPECT_NEAR(double(split.header.weight_by_order[order]) /
                        double(whole.header.weight_by_order[order]),
                    1, 0.03)
            << order;
    uint64_t deposits[2] = {0, 0};
    for (const uint32_t count : whole.counts)
        deposits[0] += count;
    for (const uint32_t count : split.counts)
        deposits[1] += count;
    EXPECT_GT(deposits[1], 14 * deposits[0]);
}

TEST(LinespaceEnergy, OfAFloorUnderABlockIsThatOfPathTracing) {
    // The floor inside the block is seen by nobody: its lines must not count.
    const BoxScene box{.albedo = 0.7f, .has_block = true, .lights = {{{0.5, 0.8, 0.5}, 1}}};
    const Posed p(reference::box_scene(box));
    const double expected = path_traced_indirect(p, 6);
    for (const double smoothing : {0.0, 1e6})
        EXPECT_NEAR(indirect_ratio(p, injection(6, 4, 300000, 6), expected, smoothing), 1, 0.02)
            << smoothing;
}

TEST(LinespaceSampling, KeepsTheDirectLightOfClosedSides) {
    // A weak lamp under a table that a strong one lights from above: so few walks meet the
    // underside that it counts as closed, and does not read the cache.
    const BoxScene box{.albedo = 0.5f,
                       .has_table = true,
                       .lights = {{{0.5, 0.9, 0.5}, 1000}, {{0.4, 0.2, 0.5}, 0.2}}};
    const Posed p(reference::box_scene(box));
    const OpenSides sides(p.posed.rays(), LightEmission(p.posed.lights()), kWorkers);
    ASSERT_GE(sides.closed_count(), 7u); // the table's underside and the outsides of the walls
    CameraChoice choice;
    choice.explicit_view = true;
    choice.look_from = V3d(0.5, 0.05, 0.6);
    choice.look_at = V3d(0.45, 0.4, 0.5);
    choice.fov_degrees = 60;
    const ChosenCamera chosen = choose_camera(p.scene, p.space, choice);
    const PixelCamera camera = pixel_camera(chosen, p.scene, p.space, 0, kPixels, kPixels);
    Progress progress;
    RenderConfig traced;
    traced.path.max_depth = 4;
    traced.path.roulette_depth = 0;
    traced.spp = 400;
    traced.aovs = kAovDirect;
    const auto seeds = fresh_seeds(3, 0, kPixels, kPixels);
    const LightCache cache = inject(p, injection(8, 4, 20000, 4));
    const ReadTable table(cache, p.space, p.posed.lights(), {1000}, kWorkers);
    SampleConfig config;
    config.read.max_depth = 4;
    config.read.roulette_depth = 0;
    config.spp = 400;
    config.layers = kLayerDirect;
    // Indirect light is another matter: voxels that the table cuts mix both sides of it.
    for (const bool all_lights : {false, true}) {
        config.read.all_lights = traced.path.all_lights = all_lights;
        const Image expected =
            render_frame(p.posed, camera, seeds, traced, nullptr, kWorkers, progress).image;
        const Image image =
            sample_frame(p.posed, camera, table, nullptr, &sides, seeds, config, kWorkers, progress)
                .image;
        EXPECT_NEAR(mean_of(image, "direct") / mean_of(expected, "direct"), 1, 0.01) << all_lights;
    }
}

TEST(LinespaceEnergy, DoesNotDependOnTheUnitOfLengthNorOnHowALightIsSplit) {
    const BoxScene box{.albedo = 0.7f, .lights = {{{0.5, 0.9, 0.5}, 1}}};
    const InjectConfig config = injection(8, 4, 100000, 4);
    const auto mean = [&](BoxScene b, double size) {
        b.size = size;
        const Posed p(reference::box_scene(b));
        return mean_of(cache_sampled(p, inject(p, config), size, 32), "indirect");
    };
    const double expected = mean(box, 1);
    EXPECT_NEAR(mean(box, 1e-3) / expected, 1, 1e-3);
    EXPECT_NEAR(mean(box, 1e3) / expected, 1, 1e-3);
    BoxScene halves = box;
    halves.lights = {{{0.5, 0.9, 0.5}, 0.5}, {{0.5, 0.9, 0.5}, 0.5}};
    EXPECT_NEAR(mean(halves, 1) / expected, 1, 0.01);
}

TEST(LinespaceEnergy, OfAThinPlateAboveTheFloorIsThatOfPathTracing) {
    // The plate and the floor share a layer of voxels.
    const BoxScene box{.albedo = 0.7f, .has_plate = true, .lights = {{{0.5, 0.8, 0.5}, 1}}};
    const Posed p(reference::box_scene(box));
    EXPECT_NEAR(indirect_ratio(p, injection(6, 4, 300000, 6), path_traced_indirect(p, 6)), 1,
                0.015);
}

TEST(LinespaceEnergy, OfWallsThatGoOnBelowTheFloorIsThatOfPathTracing) {
    // The hidden parts of the walls share a layer of voxels with what is seen of them.
    const BoxScene box{.albedo = 0.7f, .has_false_floor = true, .lights = {{{0.5, 0.8, 0.5}, 1}}};
    const Posed p(reference::box_scene(box));
    const double expected = path_traced_indirect(p, 6);
    for (const double smoothing : {0.0, 1e6})
        EXPECT_NEAR(indirect_ratio(p, injection(6, 4, 300000, 6), expected, smoothing), 1, 0.015)
            << smoothing;
}

TEST(LinespaceEnergy, OfABlurredCacheIsThatOfPathTracing) {
    for (const BoxScene& box :
         {BoxScene{.albedo = 0.7f, .has_plate = true, .lights = {{{0.5, 0.8, 0.5}, 1}}},
          BoxScene{.albedo = 0.7f, .has_block = true, .lights = {{{0.5, 0.8, 0.5}, 1}}}}) {
        const Posed p(reference::box_scene(box));
        InjectConfig config = injection(6, 4, 300000, 6);
        config.blur = {0.5, true};
        const double expected = path_traced_indirect(p, 6);
        for (const double smoothing : {0.0, 1e6})
            EXPECT_NEAR(indirect_ratio(p, config, expected, smoothing), 1, 0.02)
                << box.has_plate << " " << smoothing;
    }
}

TEST(LinespaceEnergy, OfACausticByAMirrorIsThatOfTheLightBehindIt) {
    // Direct light, mirrored: a second light at the mirror image, 0.9 as strong, without mirror.
    // Walls that reflect once only.
    const BoxScene with_mirror{
        .albedo = 0.5f, .has_mirror = true, .lights = {{{0.5, 0.6, 0.5}, 1}}};
    const Posed p(reference::box_scene(with_mirror));
    const LightCache cache = inject(p, injection(10, 4, 200000, 2));
    // At depth 2 the cache of a wall holds light of one scattering: diffuse, or by the mirror.
    double caustic = 0;
    for (size_t i = 0; i < cache.size(); ++i)
        if (cache.shafts[i] >= cache.header.caustics_from())
            caustic += std::ldexp(double(cache.sums[i][0]), -cache.header.sum_bits);
    // The share of photons that meet the wall z = 0 of the unit cube from that point: a face of
    // solid angle 4 atan(a b / (d sqrt(a^2 + b^2 + d^2))) summed over its quarters.
    double solid_angle = 0;
    for (const double y : {0.6, 0.4})
        solid_angle += 2 * std::atan(0.5 * y / (0.5 * std::sqrt(0.25 + y * y + 0.25)));
    EXPECT_NEAR(caustic / 200000, 0.9 * solid_angle / (4 * std::numbers::pi), 0.005);
}

TEST(LinespaceEstimators, OfTheThesisDependOnTheUnitOfLengthAndOnSplitLights) {
    const BoxScene box{.albedo = 0.7f, .lights = {{{0.5, 0.9, 0.5}, 1}}};
    for (const Estimator estimator : {Estimator::count_text, Estimator::count_listing}) {
        InjectConfig config = injection(8, 4, 100000, 4);
        config.estimator = estimator;
        const auto mean = [&](BoxScene b, double size) {
            b.size = size;
            const Posed p(reference::box_scene(b));
            return mean_of(cache_sampled(p, inject(p, config), size, 16), "cached");
        };
        const double one = mean(box, 1);
        BoxScene halves = box;
        halves.lights = {{{0.5, 0.9, 0.5}, 0.5}, {{0.5, 0.9, 0.5}, 0.5}};
        EXPECT_NEAR(mean(halves, 1) / one, 0.5, 0.02) << name_of(estimator);
        EXPECT_GT(std::abs(std::log2(mean(box, 10) / one)), 1) << name_of(estimator);
    }
}

TEST(LinespaceSampling, CandidatesAndTreeGiveTheSameImage) {
    const BoxScene box{.albedo = 0.7f, .has_plate = true, .lights = {{{0.5, 0.8, 0.5}, 1}}};
    const Posed p(reference::box_scene(box));
    const LightCache cache = inject(p, injection(6, 4, 100000, 5));
    const ReadTable table(cache, p.space, p.posed.lights(), {}, kWorkers);
    const ShaftCandidates candidates(p.posed.world(), table, kWorkers);
    SampleConfig config;
    config.spp = 16;
    Progress progress;
    const auto image = [&](const ShaftCandidates* c) {
        return sample_frame(p.posed, camera_of(p, 1, kPixels), table, c, nullptr,
                            fresh_seeds(4, 0, kPixels, kPixels), config, kWorkers, progress)
            .image;
    };
    const Image a = image(nullptr), b = image(&candidates);
    int different = 0;
    for (size_t i = 0; i < a.find("G")->size(); ++i) {
        const double x = double((*a.find("G"))[i]), y = double((*b.find("G"))[i]);
        different += std::abs(x - y) > 1e-4 * x;
    }
    EXPECT_LE(different, kPixels * kPixels / 50);
}

} // namespace
} // namespace ql
