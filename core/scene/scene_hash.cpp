#include "scene/scene_hash.h"

#include <bit>
#include <cstring>
#include <type_traits>

namespace ql {

namespace {

// Words are taken in one after the other: rotate, multiply (odd constants: golden ratio and
// MurmurHash3's finaliser), so that every bit of a word reaches all higher ones and back.
class Hasher {
  public:
    void word(uint64_t w) {
        m_state = std::rotl(m_state ^ (w * 0x9e3779b97f4a7c15ull), 29) * 0xff51afd7ed558ccdull;
        ++m_words;
    }
    template<class T>
    requires std::is_integral_v<T> || std::is_enum_v<T>
    void add(T value) { word(uint64_t(value)); }
    void add(float value) { word(std::bit_cast<uint32_t>(value)); }
    void add(double value) { word(std::bit_cast<uint64_t>(value)); }
    template<class T>
    void add(const Imath::Vec2<T>& v) {
        add(v.x), add(v.y);
    }
    template<class T>
    void add(const Imath::Vec3<T>& v) {
        add(v.x), add(v.y), add(v.z);
    }
    template<class T>
    void add(const Imath::Vec4<T>& v) {
        add(v.x), add(v.y), add(v.z), add(v.w);
    }
    template<class T, size_t N>
    void add(const std::array<T, N>& values) {
        for (const T& value : values)
            add(value);
    }
    template<class T>
    void add(const std::vector<T>& values) {
        word(values.size());
        for (const T& value : values)
            add(value);
    }
    void bytes(const std::vector<uint8_t>& values) {
        word(values.size());
        size_t i = 0;
        for (; i + 8 <= values.size(); i += 8) {
            uint64_t w = 0;
            std::memcpy(&w, &values[i], 8);
            word(w);
        }
        for (; i < values.size(); ++i)
            word(values[i]);
    }
    uint64_t result() const {
        // MurmurHash3's 64-bit finaliser.
        uint64_t h = m_state ^ m_words;
        h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdull;
        h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53ull;
        return h ^ (h >> 33);
    }

  private:
    uint64_t m_state = 0x243f6a8885a308d3ull; // digits of pi
    uint64_t m_words = 0;
};

void add(Hasher& h, const TextureUse& use) {
    h.add(use.texture);
    if (!use.used()) return;
    h.add(use.transfer), h.add(use.uv_set), h.add(use.wrap_s), h.add(use.wrap_t);
    h.add(use.filter), h.add(use.uv_transform);
}

void add(Hasher& h, const Material& m) {
    h.add(m.model), h.add(m.double_sided), h.add(m.base_color), h.add(m.alpha);
    add(h, m.base_color_texture);
    h.add(m.alpha_mode), h.add(m.alpha_cutoff), h.add(m.emission);
    add(h, m.emission_texture);
    add(h, m.normal_texture);
    h.add(m.normal_scale), h.add(m.metallic), h.add(m.roughness);
    add(h, m.metallic_roughness_texture);
    h.add(m.ior), h.add(m.transmission);
    add(h, m.transmission_texture);
    h.add(m.thin_walled), h.add(m.kd), h.add(m.ks), h.add(m.kr), h.add(m.kt);
    h.add(m.exponent), h.add(m.specular_color), h.add(m.fresnel);
}

void add(Hasher& h, const Mesh& mesh) {
    h.add(mesh.material), h.add(mesh.positions), h.add(mesh.normals), h.add(mesh.tangents);
    h.add(mesh.uvs), h.add(mesh.colors), h.add(mesh.triangles);
}

void add(Hasher& h, const ImplicitShape& shape) {
    h.add(shape.kind), h.add(shape.material), h.add(shape.radius), h.add(shape.height);
    h.add(shape.radius_bottom), h.add(shape.radius_top);
}

void add(Hasher& h, const Light& light) {
    h.add(light.kind), h.add(light.intensity);
    if (light.kind != Light::Kind::spot) return;
    h.add(light.inner_angle), h.add(light.outer_angle);
    h.add(light.exponent.has_value()), h.add(light.exponent.value_or(0));
}

void add_placed(Hasher& h, const Node& node, const M44d& world) {
    if (node.meshes.empty() && node.shapes.empty() && node.light < 0) return;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
            h.add(world[row][column]);
    h.add(node.meshes), h.add(node.shapes), h.add(node.light);
}

} // namespace

uint64_t scene_hash(const Scene& scene) {
    Hasher h;
    for (const Texture& texture : scene.textures) {
        h.add(texture.width), h.add(texture.height);
        h.bytes(texture.texels);
    }
    for (const Material& material : scene.materials)
        add(h, material);
    for (const Mesh& mesh : scene.meshes)
        add(h, mesh);
    for (const ImplicitShape& shape : scene.shapes)
        add(h, shape);
    for (const Light& light : scene.lights)
        add(h, light);
    const std::vector<M44d> world = world_from_nodes(scene, 0);
    for (size_t i = 0; i < scene.nodes.size(); ++i)
        add_placed(h, scene.nodes[i], world[i]);
    return h.result();
}

} // namespace ql
