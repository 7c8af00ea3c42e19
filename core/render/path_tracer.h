// Frames by path tracing: one radiance estimate per pixel from the pixel's own 32-bit seed.
//
// The image is a function of the scene, the camera, the seeds and the configuration: neither the
// number of threads nor the pixel's position enters. Moving a seed to a neighbour moves its random
// numbers there.
#pragma once

#include "base/parallel.h"
#include "base/progress.h"
#include "render/film.h"
#include "render/path_kernel.h"
#include "render/posed_scene.h"
#include "sampling/dither.h"

namespace ql {

struct RenderConfig {
    PathConfig path;
    int spp = 1;       // samples per pixel, at least 1
    uint32_t aovs = 0; // see Aov
    // If given, random numbers come from it instead of the seeds: Georgiev and Fajardo 2016.
    const DitherTile* dither = nullptr;
};

// How to find where a surface point will be in the next frame.
struct NextFrame {
    const PixelCamera& camera;
    std::vector<M44d> world_from_node; // by node
};

struct FrameResult {
    Image image;
    RayCounts rays;
    uint64_t discarded_samples = 0; // not finite, left out of their pixel's mean
};

// What the scene makes the kernel be compiled for.
struct KernelChoice {
    uint32_t lobes = 0; // a superset of what the materials need
    std::string name;   // "diffuse" or "all lobes"
};
KernelChoice choose_kernel(const Scene& scene);

// seeds: one per pixel; their size is that of the image. next is needed for kAovMotion alone.
FrameResult render_frame(const PosedScene& scene, const PixelCamera& camera,
                         const Array2D<uint32_t>& seeds, const RenderConfig& config,
                         const NextFrame* next, const Workers& workers, Progress& progress);

// Standard EXR attributes of a frame's camera.
Metadata camera_metadata(const PixelCamera& camera);

} // namespace ql
