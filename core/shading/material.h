// From a material of the scene and a surface point to what shades it: BSDF, emission, opacity,
// albedo, normal.
//
// Source: glTF 2.0, section 3.9 and appendix B; KHR_materials_ior, _transmission, _unlit; Phong
// model of Nilles 2017, section 3.2. Pure functions, safe from any thread.
#pragma once

#include "scene/scene.h"
#include "shading/bsdf.h"
#include "shading/texture.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace ql {

// What the geometry knows at a point, interpolated.
struct SurfaceInput {
    std::array<V2f, 2> uv = {V2f(0, 0), V2f(0, 0)};
    V4f color = {1, 1, 1, 1}; // COLOR_0, linear
    bool front = true;        // seen from the side that the normal of the mesh points to
};

// The lobes that points of this material can ever have. 0: it scatters nothing (unlit).
uint32_t lobes_of(const Material& material);

// Asks memory for the texels that bsdf_at and shading_normal will read here.
void prefetch_textures(std::span<const Texture> textures, const Material& material,
                       const SurfaceInput& input);

Bsdf bsdf_at(std::span<const Texture> textures, const Material& material,
             const SurfaceInput& input);

// Radiance towards the viewer, W/(m^2 sr); none from the back of a single-sided surface.
V3f emission_at(std::span<const Texture> textures, const Material& material,
                const SurfaceInput& input);

// Probability that a ray is stopped here, in [0, 1]: 0 or 1 for masks.
float alpha_at(std::span<const Texture> textures, const Material& material,
               const SurfaceInput& input);

// For the albedo channels: what a white surrounding at normal incidence shows, roughly; in [0, 1].
V3f albedo_of(const Bsdf& bsdf);
V3f albedo_at(std::span<const Texture> textures, const Material& material,
              const SurfaceInput& input);

// The shading normal: `normal` (unit) turned by the normal texture, if there is one. tangent: xyz,
// and the sign of the bitangent; of length 0 where the mesh has none, which leaves the normal.
V3f shading_normal(std::span<const Texture> textures, const Material& material,
                   const SurfaceInput& input, const V3f& normal, const V4f& tangent);

} // namespace ql

#include "shading/material_impl.h"
