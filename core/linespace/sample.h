// The sampling pass: an image of a scene with its cache.
//
// The image is a function of scene, camera, cache, seeds and configuration alone.
#pragma once

#include "base/array2d.h"
#include "base/progress.h"
#include "image/image.h"
#include "linespace/sample_kernel.h"
#include "render/posed_scene.h"

namespace ql {

// Channels beside R, G, B.
enum ReadLayer : uint32_t {
    kLayerDirect = 1 << 0,
    kLayerIndirect = 1 << 1, // cached and caustic are parts of it
    kLayerCached = 1 << 2,
    kLayerCaustic = 1 << 3,
    kLayerVariance = 1 << 4, // of the pixel's mean
};

// "direct,cached" and so on; "all". Errors: ErrorKind::usage.
uint32_t parse_read_layers(const std::string& names);

struct SampleConfig {
    ReadConfig read;
    int spp = 1;
    double blur_metres = 0; // radius of the disc that look-ups are moved on, see blur.h
    uint32_t layers = 0;    // see ReadLayer
};

struct SampleResult {
    Image image;
    ReadCounts counts;
    uint64_t discarded_samples = 0;
};

// seeds: one per pixel. candidates may be null. sides: those of the cache, null for the estimators
// of the thesis.
SampleResult sample_frame(const PosedScene& scene, const PixelCamera& camera,
                          const ReadTable& table, const ShaftCandidates* candidates,
                          const OpenSides* sides, const Array2D<uint32_t>& seeds,
                          const SampleConfig& config, const Workers& workers, Progress& progress);

} // namespace ql
