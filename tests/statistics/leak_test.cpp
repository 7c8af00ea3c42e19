// Rays stay inside of closed shapes and off their own surface. tests/bench/leak_bench counts more.
#include "reference/closed_shapes.h"

#include <gtest/gtest.h>

namespace ql {
namespace {

using namespace reference;

TEST(Leak, NoRayLeavesAClosedShapeOrMeetsItsOwnWall) {
    const Workers workers(1);
    for (const ClosedShape& shape : closed_shapes()) {
        const LeakCounts counts = count_leaks(shape, 20'000, 50, 1, 1, workers);
        EXPECT_GT(counts.rays, 900'000u) << shape.name;
        EXPECT_EQ(counts.leaks, 0u) << shape.name;
        EXPECT_EQ(counts.self_hits, 0u) << shape.name;
    }
}

// Without an offset rays do meet their own wall: the count above can fail.
TEST(Leak, RaysWithoutOffsetMeetTheirOwnWall) {
    const Workers workers(1);
    uint64_t self_hits = 0;
    for (const ClosedShape& shape : closed_shapes())
        self_hits += count_leaks(shape, 2'000, 10, 0, 1, workers).self_hits;
    EXPECT_GT(self_hits, 100u);
}

// Two parallel sheets 1e-5 of the scene apart: rays between them meet the other sheet, on its inner
// side, from either.
TEST(Leak, SheetsCloseTogetherAreToldApart) {
    const Workers workers(1);
    for (int turn = 0; turn < 8; ++turn) {
        SceneBuilder b;
        const int material = b.add_material(lambert(V3f(1)));
        b.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, material);     // front up
        b.add_quad({-1, -1, 2e-5f}, {0, 2, 0}, {2, 0, 0}, material); // front down
        for (Node& node : b.scene.nodes)
            node.matrix = rotated(V3d(turn, 2, 3).normalized(), turn * 0.4);
        const RenderSpace space = render_space_of(b.scene, workers);
        const PosedScene posed(b.scene, space, 0, workers);
        int wrong = 0;
        for (uint32_t i = 0; i < 20'000; ++i) {
            CounterRandom random(uint64_t(turn), i);
            const RandomFloats u = random.next_block(), v = random.next_block();
            V3d middle;
            b.scene.nodes[0].matrix->multVecMatrix(
                V3d(1.8 * double(u[0]) - 0.9, 1.8 * double(u[1]) - 0.9, 1e-5), middle);
            V3d up;
            b.scene.nodes[0].matrix->multDirMatrix(V3d(0, 0, u[2] < 0.5f ? 1 : -1), up);
            Ray ray{V3f(space.from_world(middle)), 0, V3f(up), kInfinity};
            Hit first, second;
            if (!posed.rays().intersect(ray, 0, first)) {
                ++wrong;
                continue;
            }
            const SurfacePoint point = geometric_point(posed.world(), ray, first);
            // Within 80 degrees of the normal, so that no ray leaves at the sides.
            const V3f local = square_to_uniform_cone({v[0], v[1]}, 0.82f);
            const V3f direction = frame_from_normal(point.ng).world_from_local(local);
            ray = {offset_origin(point.position, point.ng, point.offset, direction), 0, direction,
                   kInfinity};
            if (!posed.rays().intersect(ray, 0, second) || second.surface == first.surface ||
                geometric_point(posed.world(), ray, second).ng.dot(direction) >= 0)
                ++wrong;
        }
        EXPECT_EQ(wrong, 0) << turn;
    }
}

} // namespace
} // namespace ql
