#include "render/posed_scene.h"

#include "base/error.h"

#include <cmath>
#include <numbers>

namespace ql {

namespace {

constexpr double kDefaultFovDegrees = 45;

// Row-vector matrix of a camera at `from` that looks at `at`, y up where that is possible.
M44d look_at_matrix(const V3d& from, const V3d& at) {
    const V3d back = (from - at).normalized();
    if (!(back.length2() > 0)) throw usage_error("--look-from and --look-at are the same point");
    const bool vertical = std::abs(back.y) > 0.999999;
    const V3d up = vertical ? V3d(0, 0, 1) : V3d(0, 1, 0);
    const V3d right = up.cross(back).normalized();
    const V3d camera_up = back.cross(right);
    M44d m;
    for (int i = 0; i < 3; ++i) {
        m[0][i] = right[i];
        m[1][i] = camera_up[i];
        m[2][i] = back[i];
        m[3][i] = from[i];
    }
    return m;
}

std::vector<int> camera_nodes(const Scene& scene) {
    std::vector<int> nodes;
    for (size_t i = 0; i < scene.nodes.size(); ++i)
        if (scene.nodes[i].camera >= 0) nodes.push_back(int(i));
    return nodes;
}

int find_camera_node(const Scene& scene, const std::vector<int>& nodes, const std::string& name) {
    if (name.empty()) return nodes.front();
    for (const int node : nodes)
        if (scene.nodes[size_t(node)].name == name ||
            scene.cameras[size_t(scene.nodes[size_t(node)].camera)].name == name)
            return node;
    char* end = nullptr;
    const long index = std::strtol(name.c_str(), &end, 10);
    if (*end == '\0' && index >= 0 && size_t(index) < nodes.size()) return nodes[size_t(index)];
    std::string known;
    for (size_t i = 0; i < nodes.size(); ++i)
        known += fmt::format("{}{} ({})", i ? ", " : "", i, scene.nodes[size_t(nodes[i])].name);
    throw usage_error("--camera {}: not in the scene, which has {}", name,
                      nodes.empty() ? "none" : known);
}

// From the front, a little above, far enough to see the bounding sphere.
M44d framing_matrix(const RenderSpace& space, double fov_degrees) {
    const double radius = std::sqrt(3.0) / 2;
    const double distance = radius / std::sin(fov_degrees / 360 * std::numbers::pi);
    const V3d direction = V3d(0.4, 0.35, 1).normalized();
    return look_at_matrix(space.to_world(direction * distance), space.to_world(V3d(0)));
}

} // namespace

PosedScene::PosedScene(const Scene& scene, const RenderSpace& space, double time_seconds,
                       const Workers& workers)
    : m_world(pose_world(scene, space, time_seconds, workers)) {
    m_rays = std::make_unique<EmbreeScene>(m_world, has_alpha(scene) ? &m_alpha : nullptr, workers);
    m_lights = std::make_unique<LightSet>(m_world);
}

bool has_moving_surfaces_or_lights(const Scene& scene) {
    std::vector<char> moves(scene.nodes.size(), 0);
    for (const AnimationChannel& channel : scene.animation)
        moves[size_t(channel.node)] = 1;
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
        const Node& node = scene.nodes[i];
        if (node.parent >= 0 && moves[size_t(node.parent)]) moves[i] = 1;
        if (moves[i] && (!node.meshes.empty() || !node.shapes.empty() || node.light >= 0))
            return true;
    }
    return false;
}

ChosenCamera choose_camera(const Scene& scene, const RenderSpace& space,
                           const CameraChoice& choice) {
    ChosenCamera chosen;
    const std::vector<int> nodes = camera_nodes(scene);
    if (choice.explicit_view) {
        chosen.world_from_camera = look_at_matrix(choice.look_from, choice.look_at);
    } else if (!nodes.empty() || !choice.name.empty()) {
        chosen.node = find_camera_node(scene, nodes, choice.name);
        chosen.camera = scene.cameras[size_t(scene.nodes[size_t(chosen.node)].camera)];
    } else {
        chosen.is_framed = true;
        const double fov = choice.fov_degrees > 0 ? choice.fov_degrees : kDefaultFovDegrees;
        chosen.world_from_camera = framing_matrix(space, fov);
    }
    if (choice.fov_degrees > 0) {
        chosen.camera.orthographic = false;
        chosen.camera.yfov = choice.fov_degrees / 180 * std::numbers::pi;
    } else if (chosen.node < 0) {
        chosen.camera.yfov = kDefaultFovDegrees / 180 * std::numbers::pi;
    }
    return chosen;
}

PixelCamera pixel_camera(const ChosenCamera& chosen, const Scene& scene, const RenderSpace& space,
                         double time_seconds, int width, int height, const Imath::Box3d& bounds) {
    const M44d pose = chosen.node >= 0 ? world_from_nodes(scene, time_seconds)[size_t(chosen.node)]
                                       : chosen.world_from_camera;
    return {chosen.camera, pose, space, width, height, bounds};
}

} // namespace ql
