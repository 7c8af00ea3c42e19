#include "geometry/quadric.h"

#include "geometry/embree_scene.h"
#include "reference/scene_builder.h"
#include "sampling/random.h"
#include "sampling/warp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace ql {
namespace {

using namespace reference;

ImplicitShape sphere(float radius) {
    ImplicitShape shape;
    shape.radius = radius;
    return shape;
}

ImplicitShape cone(float height, float bottom, float top) {
    ImplicitShape shape;
    shape.kind = ImplicitShape::Kind::cone;
    shape.height = height;
    shape.radius_bottom = bottom;
    shape.radius_top = top;
    return shape;
}

// Negative inside, positive outside; of the order of the distance.
double outside(const ImplicitShape& shape, const V3d& p) {
    if (shape.kind == ImplicitShape::Kind::sphere) return p.length() - double(shape.radius);
    const double h = double(shape.height);
    const double radius =
        double(shape.radius_bottom) +
        (p.y / h + 0.5) * (double(shape.radius_top) - double(shape.radius_bottom));
    return std::max(std::hypot(p.x, p.z) - radius, std::abs(p.y) - h / 2);
}

const std::vector<ImplicitShape>& shapes() {
    static const std::vector<ImplicitShape> all = {
        sphere(1),           sphere(0.25f),       cone(2, 1, 0),      cone(1, 0, 1),
        cone(2, 0.7f, 0.7f), cone(0.1f, 1, 0.9f), cone(3, 0.2f, 0.5f)};
    return all;
}

V3d random_point(CounterRandom& random, double extent) {
    const RandomFloats u = random.next_block();
    return V3d(double(u[0]) - 0.5, double(u[1]) - 0.5, double(u[2]) - 0.5) * (2 * extent);
}

// Walks along the ray: the first hit is where the shape's inside begins or ends.
TEST(Quadric, FirstHitIsTheFirstChangeOfSide) {
    constexpr int kSteps = 2000;
    for (size_t s = 0; s < shapes().size(); ++s) {
        const ImplicitShape& shape = shapes()[s];
        int inside_starts = 0, hits = 0;
        for (uint32_t i = 0; i < 400; ++i) {
            CounterRandom random(s, i);
            const V3d origin = random_point(random, 1.5);
            const V3d direction = (random_point(random, 0.5) - origin).normalized() * 0.7;
            const double length = 8;
            const auto hit = intersect_shape(shape, origin, direction, 0, length);
            const bool starts_inside = outside(shape, origin) < 0;
            inside_starts += starts_inside;
            hits += hit.has_value();
            if (hit) {
                const V3d p = origin + direction * hit->t;
                EXPECT_NEAR(outside(shape, p), 0, 1e-12);
                EXPECT_NEAR(hit->normal.length(), 1, 1e-12);
                EXPECT_EQ(hit->normal.dot(direction) < 0, !starts_inside);
                EXPECT_GT(outside(shape, p + hit->normal * 1e-5), 0);
                EXPECT_LT(outside(shape, p - hit->normal * 1e-5), 0);
            }
            const double end = hit ? hit->t : length;
            for (int k = 1; k < kSteps; ++k) {
                const double distance = outside(shape, origin + direction * (end * k / kSteps));
                ASSERT_EQ(distance < 0, starts_inside) << "shape " << s << " ray " << i;
            }
            EXPECT_TRUE(hit || !starts_inside) << "shape " << s << " ray " << i;
        }
        EXPECT_GT(hits, 30) << s;
        EXPECT_LT(inside_starts, 400) << s;
    }
}

TEST(Quadric, RespectsBothEndsOfTheRay) {
    const auto from = V3d(0, 0, 3), along = V3d(0, 0, -1);
    EXPECT_DOUBLE_EQ(intersect_shape(sphere(1), from, along, 0, 10)->t, 2);
    EXPECT_DOUBLE_EQ(intersect_shape(sphere(1), from, along, 2, 10)->t, 4);
    EXPECT_FALSE(intersect_shape(sphere(1), from, along, 4, 10));
    EXPECT_FALSE(intersect_shape(sphere(1), from, along, 0, 2));
    EXPECT_FALSE(intersect_shape(sphere(1), from, along, 2, 4));
}

// From a million radii away the chord still has ten digits, whatever the direction's length.
TEST(Quadric, KeepsItsDigitsFromFarAway) {
    for (const double distance : {1e3, 1e6})
        for (const double speed : {1e-3, 1.0, 1e3}) {
            const V3d along = V3d(0.6, 0, 0.8) * speed;
            const V3d from = V3d(0.1, 0.2, -0.1) - along / speed * distance;
            const auto near_hit = intersect_shape(sphere(1), from, along, 0, 1e300);
            ASSERT_TRUE(near_hit);
            const V3d p = from + along * near_hit->t;
            EXPECT_NEAR(p.length(), 1, 1e-15 * distance * 4);
            EXPECT_NEAR((near_hit->normal - p).length(), 0, 1e-15 * distance * 4);
            const auto cone_hit = intersect_shape(cone(2, 1, 0.5f), from, along, 0, 1e300);
            ASSERT_TRUE(cone_hit);
            EXPECT_NEAR(outside(cone(2, 1, 0.5f), from + along * cone_hit->t), 0,
                        1e-15 * distance * 4);
        }
}

// Rays at a distance of 1 +- 1e-9 from the centre of the unit sphere.
TEST(Quadric, GrazingRaysMeetOrMiss) {
    for (const double offset : {1e-3, 1e-6, 1e-9}) {
        EXPECT_TRUE(intersect_shape(sphere(1), {1 - offset, 0, -5}, {0, 0, 1}, 0, 10));
        EXPECT_FALSE(intersect_shape(sphere(1), {1 + offset, 0, -5}, {0, 0, 1}, 0, 10));
        const ImplicitShape pipe = cone(2, 1, 1);
        EXPECT_TRUE(intersect_shape(pipe, {1 - offset, 0, -5}, {0, 0, 1}, 0, 10));
        EXPECT_FALSE(intersect_shape(pipe, {1 + offset, 0, -5}, {0, 0, 1}, 0, 10));
        EXPECT_TRUE(intersect_shape(pipe, {0, 1 - offset, -5}, {0, 0, 1}, 0, 10));
        EXPECT_FALSE(intersect_shape(pipe, {0, 1 + offset, -5}, {0, 0, 1}, 0, 10));
        // Down onto the cap, inside and outside of its edge.
        EXPECT_DOUBLE_EQ(intersect_shape(pipe, {1 - offset, 5, 0}, {0, -1, 0}, 0, 10)->t, 4);
        EXPECT_FALSE(intersect_shape(pipe, {1 + offset, 5, 0}, {0, -1, 0}, 0, 10));
    }
    // Along the side of a cone, where the quadratic degenerates.
    const auto hit = intersect_shape(cone(2, 1, 0), {-0.5, -2, 0}, {1, 2, 0}, 0, 10);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t, 0.5, 1e-12);
    // Through the tip.
    EXPECT_TRUE(intersect_shape(cone(2, 1, 0), {0, 5, 0}, {0, -1, 0}, 0, 10));
}

// As a node of the scene, squeezed and mirrored, against a fine mesh under the same node.
double volume(const ImplicitShape& shape) {
    if (shape.kind == ImplicitShape::Kind::sphere)
        return 4 * std::numbers::pi / 3 * std::pow(double(shape.radius), 3);
    const double b = double(shape.radius_bottom), t = double(shape.radius_top);
    return std::numbers::pi / 3 * double(shape.height) * (b * b + b * t + t * t);
}

// The divergence theorem: over a closed surface n sums to 0, and p . n to thrice the volume.
TEST(Quadric, UniformPointsFillTheSurfaceEvenly) {
    constexpr int kSide = 300;
    for (size_t s = 0; s < shapes().size(); ++s) {
        const ImplicitShape& shape = shapes()[s];
        V3d normals(0);
        double flux = 0;
        for (int i = 0; i < kSide; ++i)
            for (int j = 0; j < kSide; ++j) {
                const BodyPoint p = uniform_point(shape, (i + 0.5) / kSide, (j + 0.5) / kSide);
                normals += p.normal / (kSide * kSide);
                flux += p.position.dot(p.normal) / (kSide * kSide);
                EXPECT_NEAR(outside(shape, p.position), 0, 1e-12);
                EXPECT_NEAR(p.normal.length(), 1, 1e-12);
            }
        EXPECT_LT(normals.length(), 0.01) << s;
        EXPECT_NEAR(flux * shape_area(shape) / (3 * volume(shape)), 1, 0.01) << s;
    }
}

TEST(Quadric, UniformPointsHaveTheCoordinatesOfHits) {
    CounterRandom random(5, 0);
    for (size_t s = 0; s < shapes().size(); ++s)
        for (int i = 0; i < 200; ++i) {
            const RandomFloats u = random.next_block();
            const BodyPoint p = uniform_point(shapes()[s], double(u[0]), double(u[1]));
            const auto hit = intersect_shape(shapes()[s], p.position + p.normal, -p.normal, 0, 1e9);
            ASSERT_TRUE(hit) << s;
            EXPECT_NEAR(hit->t, 1, 1e-6);
            EXPECT_NEAR(hit->normal.dot(p.normal), 1, 1e-9) << s;
            EXPECT_NEAR(hit->uv.x, p.uv.x, 1e-4) << s;
            EXPECT_NEAR(hit->uv.y, p.uv.y, 1e-4) << s;
        }
}

TEST(Quadric, EqualsAFineMeshUnderAnyTransform) {
    const Workers workers(1);
    const M44d transforms[] = {
        M44d(), scaled({2, 0.1, 0.5}) * rotated(V3d(1, 1, 0).normalized(), 0.8),
        scaled({-1, 0.7, 0.3}) * rotated({0, 0, 1}, 2.0) * translated({5, 1, 0})};
    const ImplicitShape kinds[] = {sphere(1), cone(2, 1, 0.25f)};
    for (const M44d& transform : transforms)
        for (const ImplicitShape& shape : kinds) {
            SceneBuilder exact, fine;
            exact.add_material(lambert(V3f(1)));
            fine.add_material(lambert(V3f(1)));
            exact.place_shape(shape, transform);
            fine.scene.meshes.push_back(shape.kind == ImplicitShape::Kind::sphere
                                            ? sphere_mesh(256, 0)
                                            : cone_mesh(shape, 512, 1, 0));
            fine.place_mesh(0, transform);
            const RenderSpace space = render_space_of(exact.scene, workers);
            const World world_a = pose_world(exact.scene, space, 0, workers);
            const World world_b = pose_world(fine.scene, space, 0, workers);
            const EmbreeScene a(world_a, nullptr, workers), b(world_b, nullptr, workers);
            int both = 0, one = 0;
            for (uint32_t i = 0; i < 3000; ++i) {
                CounterRandom random(7, i);
                const V3d from = random_point(random, 1.0), to = random_point(random, 0.3);
                const Ray ray{V3f(from), 0, V3f(to - from), kInfinity};
                Hit hit_a, hit_b;
                const bool found_a = a.intersect(ray, 0, hit_a),
                           found_b = b.intersect(ray, 0, hit_b);
                EXPECT_EQ(found_a, a.is_occluded(ray, 0));
                one += found_a != found_b;
                if (!found_a || !found_b) continue;
                const SurfacePoint at_a = geometric_point(world_a, ray, hit_a);
                const SurfacePoint at_b = geometric_point(world_b, ray, hit_b);
                const bool grazing =
                    std::abs(at_a.ng.dot(ray.direction)) < 0.1f * ray.direction.length();
                const bool edge = at_a.ng.dot(at_b.ng) < 0.99f;
                if (grazing || edge) {
                    ++one;
                    continue;
                }
                ++both;
                EXPECT_LT((at_a.position - at_b.position).length(), 2e-3f);
                EXPECT_EQ(at_a.ng.dot(ray.direction) < 0, at_b.ng.dot(ray.direction) < 0);
            }
            EXPECT_GT(both, 500);
            EXPECT_LT(one, both / 8);
        }
}

} // namespace
} // namespace ql
