// Shadow rays of the gathers: rays per second with everything that a gather does, and of bare
// rtcOccluded1 on the very same rays. The share is the ratio of the two on one thread.
#include "geometry/ray.h"
#include "statistics/rsm_scenes.h"

#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>

#include <map>
#include <memory>

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

    Setup(const std::string& file, int map_size)
        : stage(load_gltf({std::string(QL_SOURCE_DIR) + "/examples/scenes/" + file}, {}, workers())
                    .scene,
                kSide),
          maps(stage.maps({.size = map_size})), receivers(stage.receivers()) {}
};

// Range 0: Cornell box or room corner; range 1: texels along a side of the map.
const Setup& setup(const benchmark::State& state) {
    static std::map<std::pair<int64_t, int64_t>, std::unique_ptr<Setup>> setups;
    std::unique_ptr<Setup>& found = setups[{state.range(0), state.range(1)}];
    if (!found)
        found = std::make_unique<Setup>(
            state.range(0) == 0 ? "cornell_spot.gltf" : "room_corner.gltf", int(state.range(1)));
    return *found;
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
            gatherer.irradiance(s.receivers[i], samples, shifts.place(int(i), 0, 0), 0, log));
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

void sizes(benchmark::internal::Benchmark* of) {
    of->ArgNames({"scene", "map"})->ArgsProduct({{0, 1}, {512, 1080}});
}
void one_size(benchmark::internal::Benchmark* of) {
    of->ArgNames({"scene", "map"})->ArgsProduct({{0, 1}, {512}});
}

BENCHMARK(gather<Gather::pattern>)->Apply(sizes);
BENCHMARK(bare<Gather::pattern>)->Apply(sizes);
BENCHMARK(gather<Gather::importance>)->Apply(sizes);
BENCHMARK(bare<Gather::importance>)->Apply(sizes);
BENCHMARK(gather<Gather::full>)->Apply(one_size);
BENCHMARK(bare<Gather::full>)->Apply(one_size);

} // namespace
} // namespace ql
