// What the gathers and the maps need to know of a surface that a ray has met.
//
// Everything faces the side that the ray came from. Thread-safe.
#pragma once

#include "geometry/embree_scene.h"
#include "sampling/warp.h"
#include "shading/bsdf.h"

namespace ql {

struct RsmSurface {
    V3f position = {0, 0, 0};
    V3f ng = {0, 0, 1}; // unit geometric normal towards the viewer
    float offset = 0;   // see offset_origin
    Frame frame;        // of the shading normal
    V3f wo_local = {0, 0, 1};
    Bsdf bsdf;
    V3f emission = {0, 0, 0}; // W/(m^2 sr), real values
    uint32_t surface = 0;

    const V3f& ns() const { return frame.n; }
};

// wo: unit, from the surface to the viewer.
RsmSurface read_surface(const World& world, const Ray& ray, const Hit& hit, const V3f& wo);

// The Lambert share of what the surface reflects. Under a coat the light that the coat reflects
// towards wo is missing.
V3f diffuse_albedo(const RsmSurface& surface);

// f |cos| of all lobes but the perfectly specular ones.
V3f scattered(const RsmSurface& surface, const V3f& wi);

} // namespace ql
