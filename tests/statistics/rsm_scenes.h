// Small scenes for the tests of reflective shadow maps, and short ways to render them.
#pragma once

#include "render/path_tracer.h"
#include "rsm/render.h"
#include "sampling/seeds.h"
#include "scene/gltf_load.h"

#include <memory>

namespace ql::rsm_test {

inline const Workers& workers() {
    static const Workers two(2);
    return two;
}

// A scene under construction; lengths may be scaled, with intensities so that radiance stays.
struct Builder {
    Scene scene;
    double unit = 1;

    int material(const V3f& albedo) {
        Material m;
        m.model = MaterialModel::phong;
        m.base_color = albedo;
        scene.materials.push_back(m);
        return int(scene.materials.size()) - 1;
    }

    // Its normal points along e1 x e2.
    void quad(const V3d& corner, const V3d& e1, const V3d& e2, int of_material) {
        Mesh mesh;
        mesh.material = of_material;
        for (const V3d& p : {corner, corner + e1, corner + e1 + e2, corner + e2})
            mesh.positions.emplace_back(p * unit);
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
        scene.meshes.push_back(mesh);
        Node node;
        node.meshes = {int(scene.meshes.size()) - 1};
        scene.nodes.push_back(node);
    }

    // Six quads that face inwards.
    void box(const V3d& low, const V3d& high, int of_material) {
        const V3d x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
        quad(low, z, x, of_material);
        quad(low + y, x, z, of_material);
        quad(low, x, y, of_material);
        quad(low + z, y, x, of_material);
        quad(low, y, z, of_material);
        quad(low + x, z, y, of_material);
    }

    Light& light(Light::Kind kind, const V3d& position, const V3d& direction, double intensity) {
        Light light;
        light.kind = kind;
        light.intensity = V3d(intensity * (kind == Light::Kind::directional ? 1 : unit * unit));
        scene.lights.push_back(light);
        Node node;
        node.light = int(scene.lights.size()) - 1;
        const V3d back = -direction.normalized();
        const V3d hint = std::abs(back.y) > 0.9 ? V3d(0, 0, 1) : V3d(0, 1, 0);
        const V3d right = hint.cross(back).normalized(), up = back.cross(right);
        M44d m;
        for (int i = 0; i < 3; ++i) {
            m[0][i] = right[i];
            m[1][i] = up[i];
            m[2][i] = back[i];
            m[3][i] = position[i] * unit;
        }
        node.matrix = m;
        scene.nodes.push_back(node);
        return scene.lights.back();
    }
};

inline constexpr double kDegree = 3.14159265358979323846 / 180;

// A closed box of side 2 with a block in it, lit by a spot light that leaves most of it dark.
inline Builder spot_room(double unit = 1) {
    Builder b;
    b.unit = unit;
    const int white = b.material({0.7f, 0.7f, 0.7f}), red = b.material({0.6f, 0.1f, 0.1f});
    b.box({-1, -1, -1}, {1, 1, 1}, white);
    b.quad({-0.3, -1, -0.3}, {0, 0.9, 0}, {0, 0, 0.6}, red);
    b.quad({-0.3, -0.1, -0.3}, {0, 0, 0.6}, {0.5, 0, 0}, red);
    b.quad({0.2, -1, -0.3}, {0, 0, 0.6}, {0, 0.9, 0}, red);
    Light& light = b.light(Light::Kind::spot, {-0.8, 0.5, 0.7}, {0.5, -0.6, -0.8}, 10);
    light.outer_angle = 50 * kDegree;
    light.exponent = 2;
    return b;
}

inline Scene cornell_spot() {
    return load_gltf({std::string(QL_SOURCE_DIR) + "/examples/scenes/cornell_spot.gltf"}, {},
                     workers())
        .scene;
}

// A posed scene with its camera; `from` and `at` in units of the builder.
class Stage {
  public:
    explicit Stage(Scene scene, int side, const CameraChoice& choice = {})
        : m_scene(std::move(scene)), m_space(render_space_of(m_scene, workers())),
          m_posed(m_scene, m_space, 0, workers()),
          m_camera(pixel_camera(choose_camera(m_scene, m_space, choice), m_scene, m_space, 0, side,
                                side)),
          m_side(side) {}
    Stage(const Builder& builder, int side, const V3d& from, const V3d& at, double fov = 70)
        : Stage(builder.scene, side, {"", true, from * builder.unit, at * builder.unit, fov}) {}

    const PosedScene& posed() const { return m_posed; }
    const PixelCamera& camera() const { return m_camera; }
    int side() const { return m_side; }

    Image render(const RsmConfig& config, int passes, RsmCounts* counts = nullptr,
                 const Workers& with = workers()) const {
        Progress progress;
        RsmRenderer renderer(m_posed, m_camera, m_side, m_side, config, with, progress);
        for (int i = 0; i < passes; ++i) {
            renderer.prepare_pass();
            renderer.render_pass();
        }
        if (counts) *counts = renderer.counts();
        return renderer.image();
    }

    // One bounce by path tracing, with layers.
    Image reference(int spp, uint64_t seed = 1) const {
        RenderConfig config;
        config.spp = spp;
        config.path.max_depth = 2;
        config.path.roulette_depth = 0;
        config.aovs = kAovDirect | kAovIndirect;
        Progress progress;
        return render_frame(m_posed, m_camera, fresh_seeds(seed, 0, m_side, m_side), config,
                            nullptr, workers(), progress)
            .image;
    }

    std::vector<ReflectiveShadowMap> maps(const MapConfig& config) const {
        Progress progress;
        return trace_maps(m_posed, map_lights(m_posed), config, workers(), progress);
    }

    // What the camera sees through the centres of its pixels.
    std::vector<Receiver> receivers() const {
        std::vector<Receiver> result;
        for (int y = 0; y < m_side; ++y)
            for (int x = 0; x < m_side; ++x) {
                const Ray ray = m_camera.ray(x + 0.5, y + 0.5);
                Hit hit;
                if (!m_posed.rays().intersect(ray, 0, hit)) continue;
                const RsmSurface s = read_surface(m_posed.world(), ray, hit, -ray.direction);
                result.push_back({s.position, s.ng, s.ns(), s.offset});
            }
        return result;
    }

  private:
    Scene m_scene;
    RenderSpace m_space;
    PosedScene m_posed;
    PixelCamera m_camera;
    int m_side;
};

inline RsmConfig config_of(Gather gather, int map_size, int samples = 64) {
    RsmConfig config;
    config.map.size = map_size;
    config.gather.gather = gather;
    config.gather.samples = samples;
    return config;
}

inline double mean_of(const Image& image, const std::string& layer) {
    double sum = 0;
    for (const char* c : {"R", "G", "B"})
        for (const float v : image.find(layer + c)->values())
            sum += double(v);
    return sum / (3.0 * double(image.width) * double(image.height));
}

} // namespace ql::rsm_test
