// Images by reflective shadow maps: direct light, and one diffuse bounce gathered from the maps.
//
// An image is the mean of passes; each is a function of scene, camera, configuration and its
// number. Neither the number of threads nor the order of pixels enters.
#pragma once

#include "rsm/compensation.h"
#include "rsm/direct.h"
#include "rsm/sums.h"

#include <optional>

namespace ql {

enum class Compensate { no, yes };
// centre: through the centres of the pixels, in all passes; jittered: anywhere in them.
enum class PixelPoint { centre, jittered };
// on: the gathers are timed, and their shadow rays are traced once more, alone, for comparison.
enum class RayMeasure { off, on };

struct RsmConfig {
    MapConfig map; // seed and pass are filled in
    GatherConfig gather;
    Compensate compensate = Compensate::no;
    DirectMode direct = DirectMode::ray;
    Rotation rotation = Rotation::white;
    Array2D<float> mask; // of Rotation::blue: thresholds in [0, 1)
    int interpolate = 1; // gather at every n-th pixel in both directions, [1, 16]
    PixelPoint pixel = PixelPoint::jittered;
    RayMeasure measure = RayMeasure::off;
    uint64_t seed = 0;
    uint32_t frame = 0;
    uint32_t aovs = 0; // see Aov; no motion. direct and indirect are always there
};

struct RsmCounts {
    uint64_t camera = 0;
    uint64_t direct_shadow = 0;
    uint64_t gather_shadow = 0;
    uint64_t compensation = 0;
    uint64_t compensation_shadow = 0;
    uint64_t map = 0;
    uint64_t lit_pixels = 0;          // that needed a gather
    uint64_t interpolated_pixels = 0; // and got it from their neighbours
    uint64_t discarded_samples = 0;   // not finite
    // RayMeasure::on: wall clock time, added up over threads, of gathers with all that they do, and
    // of the same shadow rays one by one through EmbreeScene::is_occluded.
    uint64_t gather_ns = 0;
    uint64_t bare_ns = 0;

    void add(const RsmCounts& other);
};

class RsmRenderer {
  public:
    // Errors: ErrorKind::input for a light that no map of that kind can hold. Scene must outlive
    // it.
    RsmRenderer(const PosedScene& scene, const PixelCamera& camera, int width, int height,
                const RsmConfig& config, const Workers& workers, Progress& progress);

    // Traces the maps of the next pass, unless those there are still serve.
    void prepare_pass();
    // Renders and adds the pass.
    void render_pass();

    int passes() const { return m_passes; }
    const std::vector<MapLight>& lights() const { return m_lights; }
    // Of the latest pass.
    const std::vector<ReflectiveShadowMap>& maps() const { return m_maps; }
    const RsmCounts& counts() const { return m_counts; }
    // The mean of all passes.
    Image image() const;

  private:
    // Frames have random numbers of their own, which no seed shares.
    uint64_t frame_seed() const;

    const PosedScene& m_scene;
    const PixelCamera& m_camera;
    RsmConfig m_config;
    const Workers& m_workers;
    Progress& m_progress;
    std::vector<MapLight> m_lights;
    std::vector<ReflectiveShadowMap> m_maps;
    std::optional<Gatherer> m_gatherer;
    PassSamples m_samples;
    PixelSumImage m_sums;
    RsmCounts m_counts;
    int m_passes = 0;
};

} // namespace ql
