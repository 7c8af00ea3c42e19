#include "bluenoise/anneal.h"
#include "bluenoise/assignment.h"
#include "bluenoise/offsets.h"
#include "bluenoise/retarget_solve.h"
#include "reference/retarget_reference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <set>

namespace ql {
namespace {

Mask mask(int width, int height, uint64_t seed = 0,
          MaskMethod method = MaskMethod::void_and_cluster) {
    MaskConfig config;
    config.method = method;
    config.width = width;
    config.height = height;
    config.seed = seed;
    Progress progress;
    Mask mask{mask_ranks(config, progress), uint32_t(width * height), ""};
    mask.hash = mask_hash(mask.values);
    return mask;
}

RetargetConfig config(Imath::V2i step, int radius, Imath::V2i motion = {0, 0}, double penalty = 0) {
    RetargetConfig config;
    config.step = step;
    config.motion = motion;
    config.radius_px = radius;
    config.move_penalty = penalty;
    return config;
}

TEST(Assignment, EqualsTheBestOfAllBijections) {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 5}, {3, 3}, {4, 2}, {8, 1}, {2, 2}})
        for (uint64_t seed = 0; seed < 4; ++seed)
            for (const int radius : {0, 1, 2})
                for (const double penalty : {0.0, 7.5}) {
                    const Mask tile = mask(width, height, seed, MaskMethod::white);
                    const RetargetConfig c = config({2, 1}, radius, {1, -1}, penalty);
                    const RetargetProblem problem(tile, c);
                    const Assignment optimum = least_cost_assignment(problem);
                    const RetargetReport report = retarget_report(problem, optimum.moves);
                    EXPECT_TRUE(report.bijection);
                    EXPECT_EQ(report.cost,
                              reference::least_retarget_cost(tile.values, c, problem.cost_units(),
                                                             problem.penalty()))
                        << width << 'x' << height << " r " << radius << " seed " << seed;
                    EXPECT_EQ(report.cost, dual_bound(problem, optimum.prices));
                }
}

TEST(Assignment, MeetsItsDualBoundOnBlueMasks) {
    for (const auto& [width, height] : {std::pair{32, 32}, {48, 20}, {13, 31}})
        for (const double penalty : {0.0, 0.2}) {
            const RetargetProblem problem(mask(width, height, 3),
                                          config(lattice_step(width, height), 6, {3, -4}, penalty));
            const Assignment optimum = least_cost_assignment(problem);
            const RetargetReport report = retarget_report(problem, optimum.moves);
            EXPECT_TRUE(report.bijection);
            EXPECT_EQ(report.cost, dual_bound(problem, optimum.prices));
            EXPECT_LT(report.energy, report.energy_initial / 20);
        }
}

TEST(Assignment, BoundOfOtherPricesIsLower) {
    const RetargetProblem problem(mask(16, 16), config({9, 9}, 4));
    Assignment optimum = least_cost_assignment(problem);
    const int64_t cost = retarget_report(problem, optimum.moves).cost;
    optimum.prices[17] += 30;
    EXPECT_LE(dual_bound(problem, optimum.prices), cost);
    EXPECT_LT(dual_bound(problem, std::vector<int64_t>(256, 0)), cost);
}

TEST(Assignment, APenaltyShortensMoves) {
    const Mask tile = mask(32, 32);
    const RetargetProblem free(tile, config({17, 19}, 6));
    const RetargetProblem dear(tile, config({17, 19}, 6, {0, 0}, 1.0));
    const auto a = retarget_report(free, least_cost_assignment(free).moves);
    const auto b = retarget_report(dear, least_cost_assignment(dear).moves);
    EXPECT_LT(b.mean_move_px, 0.7 * a.mean_move_px);
    EXPECT_GT(b.energy, a.energy);
}

TEST(RetargetReport, SeesWhatIsNoBijection) {
    const RetargetProblem problem(mask(8, 8), config({3, 5}, 2));
    Moves moves(8, 8, {0, 0});
    EXPECT_TRUE(retarget_report(problem, moves).bijection);
    moves(3, 3) = {1, 0};
    EXPECT_FALSE(retarget_report(problem, moves).bijection);
    moves(4, 3) = {-1, 0};
    EXPECT_TRUE(retarget_report(problem, moves).bijection);
    moves(0, 0) = {8, 0}; // lands where it started, but too far
    EXPECT_FALSE(retarget_report(problem, moves).bijection);
}

TEST(Anneal, KeepsItsSumsAndComesNearTheOptimum) {
    const RetargetProblem problem(mask(32, 32), config({17, 19}, 6, {2, -1}));
    const int64_t optimum = retarget_report(problem, least_cost_assignment(problem).moves).energy;
    AnnealConfig c;
    c.steps = 4000000;
    c.trace_rows = 100;
    Progress progress;
    const AnnealResult result = anneal(problem, c, progress);
    const RetargetReport report = retarget_report(problem, result.moves);
    EXPECT_TRUE(report.bijection);
    EXPECT_GE(report.energy, optimum);
    EXPECT_LT(report.energy, 2 * optimum);
    EXPECT_EQ(result.steps, c.steps);
    ASSERT_GE(result.trace.size(), 90u);
    EXPECT_EQ(result.trace.back().energy, report.energy);
    EXPECT_GT(result.trace.front().acceptance, 0.8);
    EXPECT_LT(result.trace.back().acceptance, 0.05);
}

TEST(Anneal, EveryScheduleIsAFunctionOfItsSeed) {
    const RetargetProblem problem(mask(16, 16), config({9, 9}, 4));
    Progress progress;
    for (const AnnealSchedule schedule :
         {AnnealSchedule::kirkpatrick, AnnealSchedule::exponential, AnnealSchedule::inverse,
          AnnealSchedule::linear, AnnealSchedule::hajek}) {
        AnnealConfig c;
        c.schedule = schedule;
        c.steps = 200000;
        const AnnealResult first = anneal(problem, c, progress);
        c.trace_rows = 7; // looking on changes nothing
        EXPECT_EQ(first.moves, anneal(problem, c, progress).moves);
        c.seed = 1;
        EXPECT_NE(first.moves, anneal(problem, c, progress).moves);
        const RetargetReport report = retarget_report(problem, first.moves);
        EXPECT_TRUE(report.bijection);
        EXPECT_LT(report.energy, report.energy_initial);
    }
}

TEST(Anneal, AnEquilibriumMayBeAnyNumber) {
    const RetargetProblem problem(mask(16, 16), config({9, 9}, 4));
    AnnealConfig c;
    c.steps = 20000;
    c.equilibrium = INT64_MAX;
    Progress progress;
    EXPECT_EQ(anneal(problem, c, progress).steps, c.steps);
}

TEST(Anneal, TemperaturesFollowTheirFormulas) {
    const RetargetProblem problem(mask(16, 16), config({9, 9}, 4));
    Progress progress;
    const auto last = [&](AnnealSchedule schedule) {
        AnnealConfig c;
        c.schedule = schedule;
        c.t0 = 100;
        c.alpha = 0.9;
        c.steps = 256 * 11; // k = 0 .. 10
        return anneal(problem, c, progress).final_temperature;
    };
    EXPECT_NEAR(last(AnnealSchedule::exponential), 100 * std::pow(0.9, 10), 1e-9);
    EXPECT_NEAR(last(AnnealSchedule::inverse), 100 / (1 + 0.9 * 10), 1e-9);
    EXPECT_NEAR(last(AnnealSchedule::linear), 100 * (1 - 10.0 / 11), 1e-9);
    EXPECT_NEAR(last(AnnealSchedule::hajek), 100 * std::log(2.0) / std::log(12.0), 1e-9);
}

TEST(Anneal, SnapshotsAreBijectionsAtTheirSteps) {
    const RetargetProblem problem(mask(8, 8), config({5, 3}, 3));
    AnnealConfig c;
    c.steps = 10000;
    c.snapshot_every = 3000;
    std::vector<int64_t> steps;
    c.on_snapshot = [&](int64_t step, const Moves& moves) {
        steps.push_back(step);
        EXPECT_TRUE(retarget_report(problem, moves).bijection);
    };
    Progress progress;
    anneal(problem, c, progress);
    EXPECT_EQ(steps, (std::vector<int64_t>{3000, 6000, 9000}));
}

TEST(Anneal, RefusesNonsense) {
    const RetargetProblem problem(mask(4, 4), config({1, 1}, 1));
    Progress progress;
    AnnealConfig c;
    c.alpha = 1;
    EXPECT_THROW(anneal(problem, c, progress), Error);
    c.alpha = 0.9;
    c.t0 = -1;
    EXPECT_THROW(anneal(problem, c, progress), Error);
    EXPECT_THROW(RetargetProblem(mask(4, 4), config({1, 1}, 61)), Error);
    EXPECT_THROW(RetargetProblem(mask(4, 4), config({1, 1}, 60, {61, 0})), Error);
}

TEST(RetargetFile, ComesBackFromBothFormats) {
    const Mask tile = mask(9, 7);
    const RetargetProblem problem(tile, config({4, 3}, 2, {-3, 2}));
    const RetargetTexture texture = exact_retarget_texture(tile, problem.config());
    EXPECT_EQ(texture.energy_bound, double(texture.report.energy));
    for (const RetargetEncoding encoding : {RetargetEncoding::exr, RetargetEncoding::png}) {
        Image image = retarget_image(texture, encoding);
        if (encoding == RetargetEncoding::png) image.source_bits = 8;
        const std::vector<RetargetTexture> read = retarget_textures({image}, "r");
        ASSERT_EQ(read.size(), 1u);
        EXPECT_EQ(read[0].moves, texture.moves);
        EXPECT_EQ(read[0].step, texture.step);
        EXPECT_EQ(read[0].motion, texture.motion);
        EXPECT_EQ(read[0].radius_px, 2);
        EXPECT_EQ(read[0].mask_hash, tile.hash);
        EXPECT_EQ(read[0].report.energy, texture.report.energy);
    }
}

TEST(RetargetFile, RefusesWhatIsNoBijectionAndNoTexture) {
    RetargetTexture texture{Array2D<Imath::V2i>(4, 4, {0, 0}), {1, 1}, {0, 0}, 2, "", {}, 0};
    texture.moves(1, 1) = {1, 0};
    EXPECT_THROW(retarget_textures({retarget_image(texture, RetargetEncoding::exr)}, "r"), Error);
    texture.moves(1, 1) = {0, 0};
    Image image = retarget_image(texture, RetargetEncoding::exr);
    image.metadata["ql:motion"] = std::string("65536,0");
    EXPECT_THROW(retarget_textures({image}, "r"), Error);
    image.metadata["ql:motion"] = std::string("0,0");
    EXPECT_NO_THROW(retarget_textures({image}, "r"));
    image.metadata["ql:step"] = std::string("1;1");
    EXPECT_THROW(retarget_textures({image}, "r"), Error);
    image.metadata.erase("ql:step");
    EXPECT_THROW(retarget_textures({image}, "r"), Error);
    EXPECT_THROW(retarget_textures({Image(4, 4)}, "r"), Error);
}

TEST(Offsets, LatticeStepsAreCoprimeAndNextToR2) {
    EXPECT_EQ(lattice_step(64, 64), Imath::V2i(49, 37));
    EXPECT_EQ(lattice_step(1, 1), Imath::V2i(0, 0));
    for (int n = 2; n < 200; ++n)
        EXPECT_EQ(std::gcd(lattice_step(n, n).x, n), 1);
    const MaskOffsets offsets = mask_offsets(OffsetKind::lattice, 64, 64);
    std::set<std::pair<int, int>> seen;
    for (int t = 0; t < 64; ++t)
        seen.emplace(mask_offset(offsets, t).x, mask_offset(offsets, t).y);
    EXPECT_EQ(seen.size(), 64u);
    EXPECT_EQ(mask_offset(offsets, 64), Imath::V2i(0, 0));
}

TEST(Offsets, JumpsTakeAllPlacesBeforeTheyComeBack) {
    for (const int height : {1, 7, 64, 61}) {
        const MaskOffsets offsets = mask_offsets(OffsetKind::lattice, 16, height);
        std::set<int> seen;
        for (int count = 0; count < height; ++count) {
            EXPECT_EQ(mask_jumps(offsets, count).x, 0);
            seen.insert(mask_jumps(offsets, count).y);
        }
        EXPECT_EQ(seen.size(), size_t(height));
        EXPECT_EQ(mask_jumps(offsets, height), Imath::V2i(0, 0));
    }
    EXPECT_EQ(mask_jumps(mask_offsets(OffsetKind::lattice, 64, 64), 1), Imath::V2i(0, 39));
}

// 36.5 % of the steps of int(t N / g) are (48, 36); the rest is what one texture does not fit.
TEST(Offsets, TruncatedR2TakesFourSteps) {
    const MaskOffsets r2 = mask_offsets(OffsetKind::r2, 64, 64);
    const std::vector<Imath::V2i> steps = retarget_steps(r2);
    EXPECT_EQ(steps.size(), 4u);
    int first = 0;
    for (int t = 0; t < 10000; ++t) {
        const Imath::V2i step = retarget_step(r2, t);
        EXPECT_NE(std::find(steps.begin(), steps.end(), step), steps.end());
        first += step == Imath::V2i(48, 36) ? 1 : 0;
        EXPECT_EQ(retarget_step(mask_offsets(OffsetKind::thesis, 64, 64), t), Imath::V2i(48, 36));
    }
    EXPECT_NEAR(first / 10000.0, 0.365, 0.001);
}

} // namespace
} // namespace ql
