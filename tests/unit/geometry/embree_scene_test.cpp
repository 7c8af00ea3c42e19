#include "geometry/embree_scene.h"

#include "reference/scene_builder.h"
#include "sampling/random.h"
#include "shading/alpha.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>

namespace ql {
namespace {

using namespace reference;

const Workers kOne(1);

struct Posed {
    Scene scene;
    World world;
    EmbreeScene rays;

    explicit Posed(const Scene& posed_scene)
        : scene(posed_scene), world(pose_world(scene, render_space_of(scene, kOne), 0, kOne)),
          rays(world, nullptr, kOne) {}
    Posed(const Posed&) = delete;

    Ray ray(const V3d& from, const V3d& direction) const {
        return {V3f(world.space.from_world(from)), 0, V3f(direction), kInfinity};
    }
};

V3d random_point(uint64_t key, uint32_t i, double extent) {
    CounterRandom random(key, i);
    const RandomFloats u = random.next_block();
    return V3d(double(u[0]) - 0.5, double(u[1]) - 0.5, double(u[2]) - 0.5) * (2 * extent);
}

// Two nodes with one mesh; the same triangles under separate names are not instanced.
Scene two_nodes(const M44d& first, const M44d& second, bool shared) {
    SceneBuilder b;
    b.add_material(lambert(V3f(1)));
    b.scene.meshes = {cube(4, 0), cube(4, 0)};
    b.place_mesh(0, first);
    b.place_mesh(shared ? 0 : 1, second);
    return b.scene;
}

void expect_same_hits(const Scene& instances, const Scene& copies) {
    const Posed a(instances), b(copies);
    ASSERT_TRUE(a.world.surfaces[0].instanced);
    ASSERT_FALSE(b.world.surfaces[0].instanced);
    int hits = 0, different = 0;
    for (uint32_t i = 0; i < 4000; ++i) {
        const V3d from = random_point(1, i, 1.0), to = random_point(2, i, 0.4);
        const Ray ray{V3f(from), 0, V3f(to - from), kInfinity};
        Hit hit_a, hit_b;
        const bool found_a = a.rays.intersect(ray, 0, hit_a);
        const bool found_b = b.rays.intersect(ray, 0, hit_b);
        different += found_a != found_b;
        if (!found_a || !found_b) continue;
        ++hits;
        const SurfacePoint at_a = geometric_point(a.world, ray, hit_a);
        const SurfacePoint at_b = geometric_point(b.world, ray, hit_b);
        if (at_a.surface != at_b.surface || (at_a.ng - at_b.ng).length() > 1e-4f) {
            ++different; // at an edge
            continue;
        }
        // Both lie on the surface; along grazing rays they may be further apart.
        EXPECT_LT(std::abs((at_a.position - at_b.position).dot(at_a.ng)), 2e-7f);
        EXPECT_LT((at_a.position - at_b.position).length(), 1e-4f);
        EXPECT_TRUE(std::isfinite(at_a.offset) && at_a.offset > 0);
    }
    EXPECT_GT(hits, 1000);
    EXPECT_LT(different, 4);
}

TEST(EmbreeScene, InstancesAreMetLikeCopies) {
    const M44d first = rotated(V3d(1, 2, 3).normalized(), 0.5);
    for (const M44d& second :
         {translated({3, 1, 0}), scaled({1e-2, 2, 0.5}) * translated({3, 1, 0}),
          scaled({-1, 1, 1}) * rotated({0, 1, 0}, 1.0) * translated({3, 0, 0})})
        expect_same_hits(two_nodes(first, second, true), two_nodes(first, second, false));
}

TEST(EmbreeScene, FrontsStayOutsideWhenANodeMirrors) {
    for (const bool shared : {false, true})
        for (const V3d& scale : {V3d(1), V3d(-1, 1, 1), V3d(1, -0.5, 1), V3d(-1), V3d(-2, -1, 1)}) {
            const Posed posed(two_nodes(scaled(scale), translated({9, 0, 0}), shared));
            for (uint32_t i = 0; i < 100; ++i) {
                const V3d direction = random_point(3, i, 1.0);
                const Ray ray = posed.ray(direction.normalized() * 4, -direction);
                Hit hit;
                ASSERT_TRUE(posed.rays.intersect(ray, 0, hit));
                EXPECT_LT(geometric_point(posed.world, ray, hit).ng.dot(ray.direction), 0);
            }
        }
}

// A node may squash a mesh to a sheet or to nothing: what is left is met, and nothing is NaN.
TEST(EmbreeScene, SingularTransformsLeaveASheet) {
    for (const double thickness : {0.0, 1e-30, 1e-12})
        for (const bool shared : {false, true}) {
            const Posed posed(two_nodes(scaled({1, thickness, 1}), translated({9, 0, 0}), shared));
            int hits = 0;
            for (uint32_t i = 0; i < 200; ++i) {
                V3d target = random_point(4, i, 0.9);
                target.y = 0;
                const Ray ray = posed.ray(target + V3d(0.1, 2, 0.2), {-0.1, -2, -0.2});
                Hit hit;
                if (!posed.rays.intersect(ray, 0, hit)) continue;
                const SurfacePoint point = geometric_point(posed.world, ray, hit);
                const V3d at = posed.world.space.to_world(V3d(point.position));
                EXPECT_LT((at - target).length(), 1e-5);
                EXPECT_GT(std::abs(point.ng.y), 0.999f);
                ++hits;
            }
            EXPECT_EQ(hits, 200) << "thickness " << thickness << (shared ? ", shared" : "");
        }
    for (const bool shared : {false, true}) {
        const Posed gone(two_nodes(scaled({0, 0, 0}), translated({9, 0, 0}), shared));
        Hit hit;
        EXPECT_TRUE(gone.rays.intersect(gone.ray({9, 4, 0}, {0, -1, 0}), 0, hit));
        EXPECT_FALSE(gone.rays.intersect(gone.ray({0.1, 4, 0}, {0, -1, 0}), 0, hit));
    }
}

TEST(EmbreeScene, FlatImplicitShapesAreLeftOut) {
    SceneBuilder b;
    b.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add_material(lambert(V3f(1))));
    b.place_shape({}, scaled({1, 0, 1}));
    const Posed posed(b.scene);
    EXPECT_EQ(posed.world.surfaces.size(), 1u);
}

// A texture of two texels, the left one solid, over each kind of geometry.
Scene half_transparent(AlphaMode mode, bool shared, uint8_t right_alpha) {
    SceneBuilder b;
    Material m = lambert(V3f(1));
    m.alpha_mode = mode;
    m.base_color_texture.texture = 0;
    m.base_color_texture.filter = TextureFilter::nearest;
    b.add_material(m);
    b.scene.textures.push_back({"", 2, 1, {255, 255, 255, 255, 255, 255, 255, right_alpha}});
    Mesh sheet;
    for (int j = 0; j <= 8; ++j)
        for (int i = 0; i <= 8; ++i) {
            sheet.positions.emplace_back(float(i) / 8, float(j) / 8, 0.0f);
            sheet.uvs[0].emplace_back(float(i) / 8, float(j) / 8);
        }
    for (uint32_t j = 0; j < 8; ++j)
        for (uint32_t i = 0; i < 8; ++i) {
            const uint32_t a = j * 9 + i;
            sheet.triangles.push_back({a, a + 1, a + 10});
            sheet.triangles.push_back({a, a + 10, a + 9});
        }
    b.scene.meshes.push_back(sheet);
    b.place_mesh(0);
    if (shared) b.place_mesh(0, translated({0, 0, -3}));
    return b.scene;
}

TEST(EmbreeScene, MasksCutHolesForBothKindsOfRays) {
    for (const bool shared : {false, true}) {
        const Scene scene = half_transparent(AlphaMode::mask, shared, 100);
        const PosedScene posed(scene, render_space_of(scene, kOne), 0, kOne);
        for (uint32_t i = 0; i < 200; ++i) {
            const double x = (i + 0.5) / 200;
            const Ray ray{V3f(posed.world().space.from_world({x, 0.4, 1})), 0, {0, 0, -1}, 1.0f};
            Hit hit;
            const bool solid = x < 0.5;
            // Behind the hole of a shared sheet lies the hole of its other copy.
            EXPECT_EQ(posed.rays().intersect(ray, i * 77, hit), solid) << x;
            EXPECT_EQ(posed.rays().is_occluded(ray, i * 77), solid) << x;
        }
    }
}

TEST(EmbreeScene, BlendingStopsRaysInProportionToAlpha) {
    const Scene scene = half_transparent(AlphaMode::blend, false, 64);
    const PosedScene posed(scene, render_space_of(scene, kOne), 0, kOne);
    int stopped = 0;
    constexpr int kRays = 20'000;
    for (uint32_t i = 0; i < kRays; ++i) {
        const Ray ray{V3f(posed.world().space.from_world({0.75, 0.4, 1})), 0, {0, 0, -1}, 10};
        const uint32_t key = philox4x32({i, 0, 0, 0}, {1, 2})[0];
        Hit hit;
        const bool found = posed.rays().intersect(ray, key, hit);
        EXPECT_EQ(found, posed.rays().is_occluded(ray, key)); // one key, one decision
        stopped += found;
    }
    const double share = 64.0 / 255;
    EXPECT_NEAR(stopped / double(kRays), share, 4 * std::sqrt(share * (1 - share) / kRays));
}

// Two crossings of a blended shape: each lets 1 - alpha through. Where the ray begins far away the
// place of a crossing is rounded, and must still be left behind.
TEST(EmbreeScene, BlendingHoldsForImplicitShapes) {
    Material m = lambert(V3f(1));
    m.alpha_mode = AlphaMode::blend;
    m.alpha = 0.4f;
    ImplicitShape sphere, cylinder, cone;
    cylinder.kind = cone.kind = ImplicitShape::Kind::cone;
    cylinder.radius_top = cylinder.radius_bottom;
    cone.radius_top = 0.3f * cone.radius_bottom;
    for (const ImplicitShape& shape : {sphere, cylinder, cone}) {
        SceneBuilder b;
        b.add_material(m);
        b.place_shape(shape);
        const PosedScene posed(b.scene, render_space_of(b.scene, kOne), 0, kOne);
        int stopped = 0, in_front = 0;
        constexpr int kRays = 20'000;
        for (uint32_t i = 0; i < kRays; ++i) {
            const double x = 0.15 + 0.1 * i / kRays, y = 0.1 - 0.2 * i / kRays;
            const Ray ray{V3f(posed.world().space.from_world({x, y, 4})), 0, {0, 0, -1}, 10};
            const uint32_t key = philox4x32({i, 0, 0, 0}, {1, 2})[0];
            Hit hit;
            const bool found = posed.rays().intersect(ray, key, hit);
            EXPECT_EQ(found, posed.rays().is_occluded(ray, key));
            stopped += found;
            in_front += found && hit.ng.z > 0;
        }
        EXPECT_NEAR(in_front / double(kRays), 0.4, 0.015);
        EXPECT_NEAR(stopped / double(kRays), 1 - 0.6 * 0.6, 0.015);
    }
}

TEST(EmbreeScene, RaysPassShapesThatMasksTakeAway) {
    Material m = lambert(V3f(1));
    m.alpha_mode = AlphaMode::mask;
    m.alpha = 0.1f;
    SceneBuilder b;
    b.add_material(m);
    ImplicitShape cylinder;
    cylinder.kind = ImplicitShape::Kind::cone;
    cylinder.radius_top = cylinder.radius_bottom;
    b.place_shape(cylinder);
    const PosedScene posed(b.scene, render_space_of(b.scene, kOne), 0, kOne);
    for (uint32_t i = 0; i < 1000; ++i) {
        const Ray ray{V3f(0.4f * float(i) / 1000, 0.1f, 3), 0, {0, 0, -1}, 10};
        Hit hit;
        EXPECT_FALSE(posed.rays().intersect(ray, i, hit));
    }
}

// From one point to many, in packets of every size.
void expect_packets_equal_single_rays(const PosedScene& posed) {
    int blocked = 0, rays_traced = 0;
    for (uint32_t i = 0; i < 2000; ++i) {
        const size_t count = 1 + i % kPacketRays;
        std::array<Ray, kPacketRays> rays;
        std::array<uint32_t, kPacketRays> keys;
        const V3f from(random_point(3, i, 0.6));
        uint32_t expected = 0;
        for (uint32_t k = 0; k < count; ++k) {
            rays[k] = {from, 0, V3f(random_point(4, 8 * i + k, 0.6)) - from, 1};
            keys[k] = philox4x32({i, k, 0, 0}, {1, 2})[0];
            expected |= uint32_t{posed.rays().is_occluded(rays[k], keys[k])} << k;
        }
        EXPECT_EQ(posed.rays().occluded({rays.data(), count}, keys.data()), expected) << i;
        blocked += std::popcount(expected);
        rays_traced += int(count);
    }
    EXPECT_GT(blocked, 100);
    EXPECT_LT(blocked, rays_traced - 100);
}

TEST(EmbreeScene, PacketsOfShadowRaysFindWhatSingleRaysFind) {
    for (const AlphaMode mode : {AlphaMode::opaque, AlphaMode::mask, AlphaMode::blend})
        for (const bool shared : {false, true}) {
            const Scene scene = half_transparent(mode, shared, 100);
            expect_packets_equal_single_rays({scene, render_space_of(scene, kOne), 0, kOne});
        }
    SceneBuilder b;
    Material m = lambert(V3f(1));
    m.alpha_mode = AlphaMode::blend;
    m.alpha = 0.4f;
    const int blended = b.add_material(m);
    b.add_sphere({0.5, 0, 0}, 1, blended);
    b.add_sphere({-1, 0.5, 0.2}, 0.8, b.add_material(lambert(V3f(1))));
    expect_packets_equal_single_rays({b.scene, render_space_of(b.scene, kOne), 0, kOne});
}

} // namespace
} // namespace ql
