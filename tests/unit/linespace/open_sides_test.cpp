#include "linespace/open_sides.h"

#include "reference/scene_builder.h"
#include "render/posed_scene.h"

#include <gtest/gtest.h>

namespace ql {
namespace {

using namespace reference;

const Workers kWorkers(2);

// A room lit from within, with a cube that is half sunk in the floor, and a sheet in the air. The
// room is a cube whose fronts look outside, as careless files have it.
Scene room_with_cube() {
    SceneBuilder b;
    const int white = b.add_material(lambert(V3f(0.5f)));
    const Mesh box = cube(1, white);
    const int mesh = b.add_mesh(box.positions, box.triangles, white);
    b.place_mesh(mesh, scaled({4, 4, 4}));
    const int small = b.add_mesh(box.positions, box.triangles, white);
    b.place_mesh(small, translated({0, -4, 0}));
    b.add_quad({2, 0, -1}, {0, 2, 0}, {0, 0, 2}, white);
    b.place_light(point_light(V3d(1)), translated({-1, 1, 0.3}));
    return b.scene;
}

TEST(OpenSides, AreThoseThatWalksFromTheLightsMeet) {
    const Scene scene = room_with_cube();
    const PosedScene posed(scene, render_space_of(scene, kWorkers), 0, kWorkers);
    const OpenSides sides(posed.rays(), LightEmission(posed.lights()), kWorkers);
    EXPECT_FALSE(sides.is_open(0, true)); // outside of the room
    EXPECT_TRUE(sides.is_open(0, false));
    EXPECT_TRUE(sides.is_open(1, true));
    EXPECT_FALSE(sides.is_open(1, false)); // inside of the cube
    EXPECT_TRUE(sides.is_open(2, true));
    EXPECT_TRUE(sides.is_open(2, false));
    EXPECT_EQ(sides.closed_count(), 2u);
}

TEST(OpenSides, NoLightComesFromTheInsideOfABody) {
    const Scene scene = room_with_cube();
    const PosedScene posed(scene, render_space_of(scene, kWorkers), 0, kWorkers);
    const OpenSides sides(posed.rays(), LightEmission(posed.lights()), kWorkers);
    const auto at = [&](const V3d& p) { return posed.world().space.from_world(p); };
    for (const V3d& direction : {V3d(0.3, 0.9, 0.1), V3d(1, 0, 0.2), V3d(-0.2, 0.1, 1)}) {
        EXPECT_FALSE(sides.leads_out(at({0, -3.5, 0}), direction));
        EXPECT_TRUE(sides.leads_out(at({0, -1, 0}), direction));
    }
    // Out of the scene there is a sky.
    EXPECT_TRUE(sides.leads_out(at({0, 9, 0}), {0, 1, 0}));
}

TEST(OpenSides, NoLightComesFromHiddenPartsOfASide) {
    // The walls go on below the floor.
    SceneBuilder b;
    const int white = b.add_material(lambert(V3f(0.5f)));
    const Mesh box = cube(1, white);
    b.place_mesh(b.add_mesh(box.positions, box.triangles, white), scaled({4, 4, 4}));
    b.add_quad({-4.1f, -3, -4.1f}, {0, 0, 8.2f}, {8.2f, 0, 0}, white);
    b.place_light(point_light(V3d(1)), translated({-1, 1, 0.3}));
    const PosedScene posed(b.scene, render_space_of(b.scene, kWorkers), 0, kWorkers);
    const OpenSides sides(posed.rays(), LightEmission(posed.lights()), kWorkers);
    EXPECT_TRUE(sides.is_open(0, false));
    EXPECT_EQ(sides.closed_count(), 2u); // outside of the room, underside of the floor
    EXPECT_EQ(sides.mixed_count(), 2u);  // its walls; the floor, which sticks out of them
    const auto at = [&](const V3d& p) { return posed.world().space.from_world(p); };
    for (const V3d& direction :
         {V3d(0.3, 0.9, 0.1), V3d(1, 0, 0.2), V3d(-0.2, 0.01, 1), V3d(0.5, -1, 0.2)}) {
        EXPECT_FALSE(sides.leads_out(at({0, -3.5, 0}), direction));
        EXPECT_TRUE(sides.leads_out(at({0, -1, 0}), direction));
    }
}

TEST(OpenSides, AllAreOpenWithoutLight) {
    Scene scene = room_with_cube();
    scene.lights.clear();
    for (Node& node : scene.nodes)
        node.light = -1;
    const PosedScene posed(scene, render_space_of(scene, kWorkers), 0, kWorkers);
    const OpenSides sides(posed.rays(), LightEmission(posed.lights()), kWorkers);
    EXPECT_EQ(sides.closed_count(), 0u);
}

} // namespace
} // namespace ql
