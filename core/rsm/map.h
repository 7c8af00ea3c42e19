// Reflective shadow maps: what a light sees first, texel by texel, as small diffuse lights.
//
// Sources: Dachsbacher & Stamminger, "Reflective shadow maps", I3D 2005; Nilles 2017, sections 3.5
// and 5.1. The flux of a texel is I(theta) dOmega rho, in watts (times RenderSpace::scale^2 and
// 2^-LightSet::exponent, see MapLight). A texel shines into the half space of its geometric normal
// N; where shading normals differ from it, the flux carries the factor cos_shading / cos_geometric
// of the incoming light (Veach 1997, section 5.3), so that the sum over all texels is what a path
// tracer finds. Immutable once traced, hence safe to share between threads.
#pragma once

#include "base/progress.h"
#include "rsm/projection.h"
#include "rsm/surface.h"

#include <cstdint>
#include <vector>

namespace ql {

// Where in its texel a ray goes.
enum class TexelPoint { centre, jittered };
// Nilles 2017 leaves the solid angle out: then "flux" is intensity times albedo.
enum class FluxMeasure { watts, intensity };

struct MapConfig {
    int size = 1080; // texels along a side, [1, 16384]
    MapKind kind = MapKind::equal_area;
    TexelPoint point = TexelPoint::centre;
    FluxMeasure measure = FluxMeasure::watts;
    uint64_t seed = 0; // of jittered points and alpha decisions
    uint32_t pass = 0; // passes are independent
};

// One array for each value, row by row, as the gathers read them. Texels that saw nothing or
// reflect nothing have flux 0; those that saw nothing have normal 0.
struct Texels {
    std::vector<float> px, py, pz; // position, render space
    std::vector<float> nx, ny, nz; // geometric normal, on the side of the light
    std::vector<float> red, green, blue;
    std::vector<float> radius2; // of a disc as large as the texel's piece of surface
    std::vector<float> offset;  // shadow rays end that far off the surface
    std::vector<float> depth;   // along the ray; infinite where there is nothing

    explicit Texels(size_t count = 0);
    size_t count() const { return px.size(); }
    V3f position(size_t i) const { return {px[i], py[i], pz[i]}; }
    V3f normal(size_t i) const { return {nx[i], ny[i], nz[i]}; }
    V3f flux(size_t i) const { return {red[i], green[i], blue[i]}; }
};

// Bytes that a map of that size takes, with what a gather keeps beside it.
size_t map_bytes(int size);

struct ReflectiveShadowMap {
    std::string name;
    MapLight light;
    MapProjection projection;
    int size = 0;
    Texels texels;
    size_t lit_texels = 0; // of flux above 0
    V3d flux = {0, 0, 0};  // sum over all texels

    // The texel that a point of the square lies in; -1 outside.
    int64_t texel_at(float u, float v) const;
};

// A map for each of the lights (six for the perspective map of a point light).
std::vector<ReflectiveShadowMap> trace_maps(const PosedScene& scene,
                                            const std::vector<MapLight>& lights,
                                            const MapConfig& config, const Workers& workers,
                                            Progress& progress);

// Squared radius, of what a texel of this measure covers at a hit: area / pi.
float texel_radius2(double texel_measure, bool is_directional, float distance, float cos_light);

} // namespace ql
