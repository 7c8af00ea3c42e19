// Shadow rays of the gathers: rays per second with everything that a gather does, and of bare
// rtcOccluded1 on the very same rays. The share is the ratio of the two on one thread.
#include "geometry/ray.h"
#include "statistics/rsm_scenes.h"

#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>

namespace ql {
namespace {

using namespace rsm_test;

constexpr int kSide = 48;

// The triangles of a world without anything of ours around them.
class BareScene {
  public:
    explicit BareScene(const World& world)
        : m_device(rtcNewDevice("threads=1")), m_scene(rtcNewScene(m_device)) {
        rtcSetSceneFlags(m_scene, RTC_SCENE_FLAG_ROBUST);
        for (const Surface& surface : world.surfaces) {
            const Mesh& mesh = world.scene->meshes[size_t(surface.mesh)];
            const RTCGeometry geometry = rtcNewGeometry(m_device, RTC_GEOMETRY_TYPE_TRIANGLE);
            rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                       surface.body->positions.data(), 0, sizeof(V3f),
                                       mesh.positions.size());
            rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                       mesh.triangles.data(), 0, 3 * sizeof(uint32_t),
                                       mesh.triangles.size());
            rtcCommitGeometry(geometry);
            rtcAttachGeometry(m_scene, geometry);
            rtcReleaseGeometry(geometry);
        }
        rtcCommitScene(m_scene);
    }
    BareScene(const BareScene&) = delete;
    BareScene& operator=(const BareScene&) = delete;
    ~BareScene() {
        rtcReleaseScene(m_scene);
        rtcReleaseDevice(m_device);
    }

    bool is_occluded(const Ray& from) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        RTCRay ray{from.origin.x,
                   from.origin.y,
                   from.origin.z,
                   0,
                   from.direction.x,
                   from.direction.y,
                   from.direction.z,
                   0,
                   from.t_far,
                   ~0u,
                   0,
                   0};
        rtcOccluded1(m_scene, &context, &ray);
        return ray.tfar < 0;
    }

  private:
    RTCDevice m_device;
    RTCScene m_scene;
};

struct Setup {
    Stage stage;
    std::vector<ReflectiveShadowMap> maps;
    std::vector<Receiver> receivers;

    explicit Setup(const std::string& file)
        : stage(load_gltf({std::string(QL_SOURCE_DIR) + "/examples/scenes/" + file}, {}, workers())
                    .scene,
                kSide),
          maps(stage.maps({.size = 512})), receivers(stage.receivers()) {}
};

const Setup& setup(const benchmark::State& state) {
    static const Setup cornell("cornell_spot.gltf"), corner("room_corner.gltf");
    return state.range(0) == 0 ? cornell : corner;
}

PassSamples samples_of(const GatherConfig& config) {
    return config.gather == Gather::pattern ? pattern_samples(config.samples, 0, 0)
                                            : importance_samples(config.samples, 0, 0);
}

// full is measured on some of the receivers: it takes every texel of the map for each.
uint64_t gather_all(const Setup& s, const Gatherer& gatherer, const PassSamples& samples,
                    std::vector<Ray>* rays) {
    ShadowLog log;
    log.rays = rays;
    const ShiftSource shifts{Rotation::white, nullptr, 0};
    const size_t step = gatherer.config().gather == Gather::full ? 64 : 1;
    for (size_t i = 0; i < s.receivers.size(); i += step)
        benchmark::DoNotOptimize(
            gatherer.irradiance(s.receivers[i], samples, shifts.shift(int(i), 0, 0), 0, log));
    return log.count;
}

template<Gather Kind>
void gather(benchmark::State& state) {
    const Setup& s = setup(state);
    const GatherConfig config{.gather = Kind, .samples = 100};
    const Gatherer gatherer(s.stage.posed().rays(), s.maps, config);
    const PassSamples samples = samples_of(config);
    uint64_t rays = 0;
    for (auto _ : state)
        rays += gather_all(s, gatherer, samples, nullptr);
    state.counters["rays"] = benchmark::Counter(double(rays), benchmark::Counter::kIsRate);
}

template<Gather Kind>
void bare(benchmark::State& state) {
    const Setup& s = setup(state);
    const GatherConfig config{.gather = Kind, .samples = 100};
    const Gatherer gatherer(s.stage.posed().rays(), s.maps, config);
    std::vector<Ray> rays;
    gather_all(s, gatherer, samples_of(config), &rays);
    const BareScene scene(s.stage.posed().world());
    for (auto _ : state)
        for (const Ray& ray : rays)
            benchmark::DoNotOptimize(scene.is_occluded(ray));
    state.counters["rays"] = benchmark::Counter(double(rays.size()) * double(state.iterations()),
                                                benchmark::Counter::kIsRate);
}

// Range 0: Cornell box; 1: room corner.
BENCHMARK(gather<Gather::pattern>)->Arg(0)->Arg(1);
BENCHMARK(bare<Gather::pattern>)->Arg(0)->Arg(1);
BENCHMARK(gather<Gather::importance>)->Arg(0)->Arg(1);
BENCHMARK(bare<Gather::importance>)->Arg(0)->Arg(1);
BENCHMARK(gather<Gather::full>)->Arg(0)->Arg(1);
BENCHMARK(bare<Gather::full>)->Arg(0)->Arg(1);

} // namespace
} // namespace ql
