// The injection pass: photons from the lights into a cache.
//
// Source: Nilles 2017, sections 4.2.2 and 5.2.6, with the estimators of cache.h. The result is a
// function of scene, configuration and photon range: threads do not matter, and caches of adjacent
// ranges merge to that of the whole, byte for byte.
#pragma once

#include "base/progress.h"
#include "linespace/cache.h"
#include "linespace/measure.h"
#include "linespace/photon_kernel.h"
#include "render/posed_scene.h"

namespace ql {

struct InjectConfig {
    GridConfig grid;
    int patches = 4; // N, 1 to kMaxPatches
    int normal_classes = 6;
    Estimator estimator = Estimator::energy;
    int max_depth = 5; // scatterings of the joined path, at least 2
    int branches = 8;  // into which a photon is split where it first scatters; energy alone
    uint64_t seed = 0;
    PhotonRange photons{0, 1000000};
    BlurRadius blur; // energy alone
    MeasureConfig measure;
};

struct InjectReport {
    PhotonCounts photons;
    MeasureReport measure;
    double seconds_tracing = 0;
    double seconds_measuring = 0;
};

// The header that inject() gives its cache, but for the weights that arrive.
CacheHeader inject_header(const PosedScene& scene, uint64_t scene_hash, const InjectConfig& config);

// scene_hash: of the scene, for the header. Errors: ErrorKind::usage where the configuration does
// not fit the scene.
LightCache inject(const PosedScene& scene, uint64_t scene_hash, const InjectConfig& config,
                  const Workers& workers, Progress& progress, InjectReport& report);

} // namespace ql
