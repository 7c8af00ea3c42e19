#include "render/camera.h"

#include "reference/scene_builder.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ql {
namespace {

using namespace reference;

constexpr int kWidth = 64, kHeight = 48;

Camera perspective() {
    Camera camera;
    camera.yfov = 0.7;
    return camera;
}

Camera orthographic() {
    Camera camera;
    camera.orthographic = true;
    camera.ymag = 1.5;
    return camera;
}

const M44d kPose = rotated(V3d(1, 2, -1).normalized(), 0.6) * translated({2, -1, 3});
const RenderSpace kSpace{{1, 2, 3}, 0.25};

// The point that a ray reaches after `metres`, in world space.
V3d along(const PixelCamera& camera, double x, double y, double metres) {
    const Ray ray = camera.ray(x, y);
    return kSpace.to_world(V3d(ray.origin) + V3d(ray.direction) * metres * kSpace.scale);
}

TEST(Camera, PointsOnTheRayOfAPixelProjectToIt) {
    for (const Camera& kind : {perspective(), orthographic()}) {
        const PixelCamera camera(kind, kPose, kSpace, kWidth, kHeight);
        for (const auto& [x, y] : {std::pair{0.0, 0.0}, {64.0, 48.0}, {10.25, 40.75}, {32.0, 24.0}})
            for (const double metres : {0.5, 3.0}) {
                const auto there = camera.project(along(camera, x, y, metres));
                EXPECT_NEAR(there.x, x, 2e-4);
                EXPECT_NEAR(there.y, y, 2e-4);
                EXPECT_GT(there.depth, 0);
            }
    }
}

// By hand: the camera at (2, -1, 3) unturned, a point 4 m ahead, 1 m to the right, 0.5 m up.
TEST(Camera, ProjectsAsComputedByHand) {
    const PixelCamera camera(perspective(), translated({2, -1, 3}), kSpace, kWidth, kHeight);
    const auto there = camera.project({3, -0.5, -1});
    const double focal_px = kHeight / 2 / std::tan(0.35);
    EXPECT_NEAR(there.x, kWidth / 2 + focal_px * 1 / 4, 1e-12);
    EXPECT_NEAR(there.y, kHeight / 2 - focal_px * 0.5 / 4, 1e-12);
    EXPECT_NEAR(there.depth, 4, 1e-12);
    const auto behind = camera.project({2, -1, 5});
    EXPECT_NEAR(behind.depth, -2, 1e-12);
}

TEST(Camera, ExrMatricesProjectPointsToTheirPixels) {
    for (const Camera& kind : {perspective(), orthographic()}) {
        const PixelCamera camera(kind, kPose, kSpace, kWidth, kHeight);
        for (const auto& [x, y] : {std::pair{5.0, 7.0}, {60.5, 3.25}}) {
            const V3d world = along(camera, x, y, 2);
            Imath::V3f ndc, in_camera;
            camera.world_to_ndc().multVecMatrix(V3f(world), ndc); // divides by w
            EXPECT_NEAR(double(ndc.x) * kWidth, x, 1e-3);
            EXPECT_NEAR(double(ndc.y) * kHeight, y, 1e-3);
            camera.world_to_camera().multVecMatrix(V3f(world), in_camera);
            EXPECT_NEAR(double(in_camera.z), camera.depth(world), 1e-5);
            EXPECT_EQ(in_camera.x > 0, x > kWidth / 2);
            EXPECT_EQ(in_camera.y > 0, y < kHeight / 2);
        }
    }
}

// The matrix has the accuracy of its float entries, not of products of rounded ones.
TEST(Camera, ExrMatricesKeepFloatAccuracyAwayFromTheOrigin) {
    const M44d pose = rotated({0, 1, 0}, 0.7) * translated({1000, 20, -3000});
    const PixelCamera camera(perspective(), pose, {{1000, 20, -3000}, 0.25}, kWidth, kHeight);
    V3d world;
    pose.multVecMatrix(V3d(0.3, 0.2, -5), world);
    const auto exact = camera.project(world);
    const Imath::M44f m = camera.world_to_ndc();
    V3d ndc;
    M44d(m).multVecMatrix(world, ndc);
    EXPECT_NEAR(ndc.x * kWidth, exact.x, 0.01);
    EXPECT_NEAR(ndc.y * kHeight, exact.y, 0.01);
}

TEST(Camera, ScaleOfTheNodeChangesNothing) {
    const PixelCamera plain(perspective(), kPose, kSpace, kWidth, kHeight);
    const PixelCamera large(perspective(), scaled(V3d(7)) * kPose, kSpace, kWidth, kHeight);
    const auto a = plain.project({1, 2, -4}), b = large.project({1, 2, -4});
    EXPECT_NEAR(a.x, b.x, 1e-9);
    EXPECT_NEAR(a.y, b.y, 1e-9);
    EXPECT_NEAR(a.depth, b.depth, 1e-9);
}

// From 1e5 scene sizes away: the rays start near the scene and still go through their points.
TEST(Camera, FarCamerasKeepTheirAim) {
    SceneBuilder b;
    b.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add_material(lambert(V3f(0.5f))));
    RenderConfig config;
    config.aovs = kAovDepth | kAovPosition;
    config.path.sky = V3f(1);
    for (const double distance : {10.0, 1e3, 1e5}) {
        const View view{{0, 0, distance}, {0, 0, 0}, 2 / distance * 57.3, 8, 8};
        const FrameResult result = render_scene(b.scene, view, config);
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x) {
                EXPECT_NEAR((*result.image.find("Z"))(x, y) / distance, 1, 1e-6);
                EXPECT_NEAR((*result.image.find("P.X"))(x, y), (x + 0.5) / 4 - 1, 0.13);
                EXPECT_NEAR((*result.image.find("P.Y"))(x, y), 1 - (y + 0.5) / 4, 0.13);
            }
    }
}

// What moves towards a camera far away must not be left behind by rays that start near the scene.
TEST(Camera, RaysOfFarCamerasStartBeforeWhatHasMoved) {
    const PixelCamera camera(perspective(), translated({0, 0, 6}), {}, kWidth, kHeight,
                             Imath::Box3d(V3d(-0.5, -0.5, 3), V3d(0.5, 0.5, 3.5)));
    EXPECT_GT(camera.ray(kWidth / 2.0, kHeight / 2.0).origin.z, 3.5f);
}

} // namespace
} // namespace ql
