#include "scene/features.h"

#include <fmt/format.h>

#include <set>

namespace ql {

namespace {

bool emits(const Scene& scene, int material) {
    const Material& m = scene.materials[size_t(material)];
    return m.model != MaterialModel::unlit && m.emission != V3f(0);
}

bool is_textured(const Material& m) {
    return m.base_color_texture.used() || m.emission_texture.used() || m.normal_texture.used() ||
           m.metallic_roughness_texture.used() || m.transmission_texture.used();
}

void count_material(const Material& m, SceneFeatures& f) {
    const bool phong = m.model == MaterialModel::phong;
    const bool metallic_roughness = m.model == MaterialModel::metallic_roughness;
    f.metallic_roughness_materials += metallic_roughness;
    f.transmissive_materials += metallic_roughness && m.transmission > 0;
    f.phong_diffuse_materials += phong && m.kd > 0;
    f.phong_glossy_materials += phong && m.ks > 0;
    f.phong_specular_materials += phong && (m.kr > 0 || m.kt > 0);
    f.unlit_materials += m.model == MaterialModel::unlit;
    f.emissive_materials += m.model != MaterialModel::unlit && m.emission != V3f(0);
    f.textured_materials += is_textured(m);
    f.normal_mapped_materials += m.normal_texture.used();
    f.alpha_mask_materials += m.alpha_mode == AlphaMode::mask;
    f.alpha_blend_materials += m.alpha_mode == AlphaMode::blend;
}

void count_mesh(const Scene& scene, const Mesh& mesh, SceneFeatures& f) {
    ++f.mesh_instances;
    f.triangles += mesh.triangles.size();
    f.vertex_color_instances += !mesh.colors.empty();
    if (emits(scene, mesh.material)) f.emissive_triangles += mesh.triangles.size();
}

void count_light(const Light& light, SceneFeatures& f) {
    f.point_lights += light.kind == Light::Kind::point;
    f.spot_lights += light.kind == Light::Kind::spot;
    f.directional_lights += light.kind == Light::Kind::directional;
}

} // namespace

SceneFeatures required_features(const Scene& scene) {
    SceneFeatures f;
    f.textures = scene.textures.size();
    std::set<int> meshes;
    std::set<int> materials;
    for (const Node& node : scene.nodes) {
        for (const int index : node.meshes) {
            const Mesh& mesh = scene.meshes[size_t(index)];
            count_mesh(scene, mesh, f);
            materials.insert(mesh.material);
            if (meshes.insert(index).second) f.unique_triangles += mesh.triangles.size();
        }
        for (const int index : node.shapes) {
            const ImplicitShape& shape = scene.shapes[size_t(index)];
            f.spheres += shape.kind == ImplicitShape::Kind::sphere;
            f.cones += shape.kind == ImplicitShape::Kind::cone;
            f.emissive_shapes += emits(scene, shape.material);
            materials.insert(shape.material);
        }
        if (node.light >= 0) count_light(scene.lights[size_t(node.light)], f);
        f.cameras += node.camera >= 0;
    }
    for (const int material : materials)
        count_material(scene.materials[size_t(material)], f);
    std::set<int> moved;
    for (const AnimationChannel& channel : scene.animation)
        moved.insert(channel.node);
    f.animated_nodes = moved.size();
    return f;
}

std::string feature_line(const SceneFeatures& f) {
    std::string line;
    const auto add = [&](uint64_t count, const char* one, const char* many) {
        if (count > 0)
            line +=
                fmt::format("{}{} {}", line.empty() ? "" : ", ", count, count == 1 ? one : many);
    };
    add(f.triangles, "triangle", "triangles");
    if (f.unique_triangles != f.triangles) line += fmt::format(" ({} stored)", f.unique_triangles);
    add(f.mesh_instances, "mesh instance", "mesh instances");
    add(f.spheres, "sphere", "spheres");
    add(f.cones, "cone", "cones");
    add(f.vertex_color_instances, "mesh with vertex colours", "meshes with vertex colours");
    add(f.textures, "texture", "textures");
    const std::pair<uint64_t, const char*> materials[] = {
        {f.metallic_roughness_materials, "metallic-roughness"},
        {f.transmissive_materials, "transmissive"},
        {f.phong_diffuse_materials, "Phong diffuse"},
        {f.phong_glossy_materials, "Phong glossy"},
        {f.phong_specular_materials, "Phong specular"},
        {f.unlit_materials, "unlit"},
        {f.emissive_materials, "emissive"},
        {f.textured_materials, "textured"},
        {f.normal_mapped_materials, "normal-mapped"},
        {f.alpha_mask_materials, "alpha-masked"},
        {f.alpha_blend_materials, "alpha-blended"}};
    for (const auto& [count, name] : materials)
        add(count, fmt::format("{} material", name).c_str(),
            fmt::format("{} materials", name).c_str());
    add(f.point_lights, "point light", "point lights");
    add(f.spot_lights, "spot light", "spot lights");
    add(f.directional_lights, "directional light", "directional lights");
    add(f.emissive_triangles, "emissive triangle", "emissive triangles");
    add(f.emissive_shapes, "emissive shape", "emissive shapes");
    add(f.cameras, "camera", "cameras");
    add(f.animated_nodes, "animated node", "animated nodes");
    return line;
}

} // namespace ql
