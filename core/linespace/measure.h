// The measure G_s f_s of directed shafts: how much of their étendue meets surfaces that take light.
//
// f_s is the share of the shaft's lines, by the invariant measure cos_a cos_b / r^2 dA_a dA_b, that
// coming from the light's side first meet such a surface inside the voxel; for the caustic layer
// the mean number of such surfaces on a line. Lines join low-discrepancy points on both patches; a
// first set of 32 decides how many more a shaft needs. An unbiased f makes 1/f biased: for n of
// K random lines, the inverse of (n + 1)/(K + 1) is unbiased but for (1 - f)^(K + 1). Ours are
// stratified and vary less the more of them hit, so that from one hit down to a half is added, by a
// constant that was fitted to the mean of one scene, a Cornell box, against path tracing. With a
// blur (blur.h) a line counts for the point on it that another point is moved to, if light comes to
// that one past the voxel. Groups of shafts (groups.h) share lines through the whole voxel. Depends
// on the scene, the grid and the shaft or group alone.
#pragma once

#include "base/progress.h"
#include "geometry/embree_scene.h"
#include "linespace/blur.h"
#include "linespace/cache.h"
#include "linespace/groups.h"
#include "linespace/open_sides.h"

namespace ql {

struct MeasureConfig {
    int max_lines = 256;  // of a shaft, a multiple of 32
    int enough_hits = 24; // that the number of lines aims at
    int least_voxel_lines = 1024;
    int max_voxel_lines = 8192;   // for the groups of a voxel, a multiple of 32
    int enough_voxel_hits = 1024; // of each class of normals
    int enough_open = 256;        // hits of a voxel whose lines are all asked whether they are open
};

struct MeasureReport {
    uint64_t lines = 0;
    uint64_t unmeasured_shafts = 0; // no line met a surface
    double unmeasured_weight = 0;   // of the photons in those, mean over R, G, B
};

// Fills cache.measures, and cache.groups with all that belongs to it. alpha_test may be null where
// no material has an alpha mode.
MeasureReport measure_shafts(const World& world, const OpenSides& sides,
                             const AlphaTest* alpha_test, const Blur& blur,
                             const MeasureConfig& config, LightCache& cache, const Workers& workers,
                             Progress& progress);

} // namespace ql
