// What a scene requires of a renderer: the basis for choosing kernels and for what --stats prints.
#pragma once

#include "scene/scene.h"

#include <cstdint>
#include <string>

namespace ql {

// Counts are of what nodes place in the world (an instance counts each time); materials count once.
struct SceneFeatures {
    // Geometry.
    uint64_t triangles = 0;
    uint64_t unique_triangles = 0; // without further instances of the same mesh
    uint64_t mesh_instances = 0;
    uint64_t spheres = 0;
    uint64_t cones = 0;
    uint64_t vertex_color_instances = 0;

    // Materials and textures.
    uint64_t textures = 0;
    uint64_t metallic_roughness_materials = 0;
    uint64_t transmissive_materials = 0; // metallic-roughness with transmission
    uint64_t phong_diffuse_materials = 0;
    uint64_t phong_glossy_materials = 0;   // ks > 0
    uint64_t phong_specular_materials = 0; // kr > 0 or kt > 0
    uint64_t unlit_materials = 0;
    uint64_t emissive_materials = 0;
    uint64_t textured_materials = 0;
    uint64_t normal_mapped_materials = 0;
    uint64_t alpha_mask_materials = 0;
    uint64_t alpha_blend_materials = 0;

    // Lights, cameras, motion.
    uint64_t point_lights = 0;
    uint64_t spot_lights = 0;
    uint64_t directional_lights = 0;
    uint64_t emissive_triangles = 0;
    uint64_t emissive_shapes = 0;
    uint64_t cameras = 0;
    uint64_t animated_nodes = 0; // those moved by a channel, not their descendants

    bool has_light() const {
        return point_lights + spot_lights + directional_lights + emissive_triangles +
                   emissive_shapes >
               0;
    }
};

SceneFeatures required_features(const Scene& scene);

// "32 triangles, 5 phong diffuse materials, 1 point light, 1 camera": what is not there is not
// mentioned.
std::string feature_line(const SceneFeatures& features);

} // namespace ql
