// Linespace caches: read, merged with themselves, and sampled in 2 x 2 pixels.
//
// Input that is no OpenEXR file is a list of edits to a good cache, so that what lies behind the
// compression and the digest is reached, too: each edit is 6 bytes, what, where (2), value (3).
#include "fuzz.h"

#include "image/deep_image.h"
#include "linespace/cache_file.h"
#include "linespace/inject.h"
#include "linespace/sample.h"
#include "reference/scene_builder.h"
#include "render/path_tracer.h"
#include "sampling/seeds.h"

#include <array>
#include <bit>
#include <cstring>
#include <limits>

namespace {

using namespace ql;
using namespace ql::reference;

struct World2x2 {
    Workers workers{1};
    Scene scene = [] {
        SceneBuilder b;
        b.scene = cornell(glossy(V3f(0.5f), 0.5f, 20), emitter(V3f(12, 10, 8)));
        return b.scene;
    }();
    RenderSpace space = render_space_of(scene, workers);
    PosedScene posed{scene, space, 0, workers};
    PixelCamera camera = camera_of(cornell_view(2), scene, space);
    LightCache good = [this] {
        InjectConfig config;
        config.grid.voxels = {3, 2, 2};
        config.patches = 2;
        config.photons = {0, 200};
        InjectReport report;
        Progress quiet;
        return inject(posed, 1, config, workers, quiet, report);
    }();
};

const World2x2& world() {
    static const World2x2 instance;
    return instance;
}

// Values at the ends of their types come up more often than by chance.
template<class T>
T value_from(uint32_t bits) {
    constexpr std::array<T, 8> ends = {T(0),
                                       T(1),
                                       std::numeric_limits<T>::max(),
                                       std::numeric_limits<T>::lowest(),
                                       T(std::numeric_limits<T>::max() / 2 + 1),
                                       T(6),
                                       T(63),
                                       T(1 << 14)};
    return bits & 1 ? ends[bits >> 1 & 7] : T(bits >> 1);
}

float float_from(uint32_t bits) {
    return std::bit_cast<float>(bits << 8 | (bits & 0xff));
}

void edit_header(CacheHeader& h, uint32_t where, uint32_t value) {
    switch (where % 16) {
    case 0:
        h.estimator = Estimator(value % 3);
        break;
    case 1:
        h.patches = value_from<int>(value);
        break;
    case 2:
        h.normal_classes = value_from<int>(value);
        break;
    case 3:
    case 4:
    case 5:
        h.voxels[where % 3] = value_from<int>(value);
        break;
    case 6:
        h.lower[int(where / 16 % 3)] = double(float_from(value));
        break;
    case 7:
        h.cell[int(where / 16 % 3)] = double(float_from(value));
        break;
    case 8:
        h.max_depth = value_from<int>(value);
        break;
    case 9:
        h.sum_bits = value_from<int>(value);
        break;
    case 10:
        h.unit = double(float_from(value));
        break;
    case 11:
        h.photons.push_back({value_from<uint64_t>(value), value_from<uint64_t>(where)});
        break;
    case 12:
        h.photons.clear();
        break;
    case 13:
        h.weight_by_order.push_back(value_from<int64_t>(value));
        break;
    case 14:
        if (!h.weight_by_order.empty())
            h.weight_by_order[where / 16 % h.weight_by_order.size()] = value_from<int64_t>(value);
        break;
    default:
        if (where / 16 % 3 == 0)
            h.unclassified = value_from<int64_t>(value);
        else if (where / 16 % 3 == 1)
            h.blur = double(float_from(value));
        else if (!h.caustic_by_order.empty())
            h.caustic_by_order[where / 48 % h.caustic_by_order.size()] = value_from<int64_t>(value);
        break;
    }
}

void edit(LightCache& cache, uint32_t what, uint32_t where, uint32_t value) {
    const size_t entry = cache.size() == 0 ? 0 : where % cache.size();
    switch (what % 6) {
    case 0:
        edit_header(cache.header, where, value);
        break;
    case 1:
        cache.shafts[entry] = value_from<uint32_t>(value);
        break;
    case 2:
        cache.counts[entry] = value_from<uint32_t>(value);
        break;
    case 3:
        cache.sums[entry][value % 3] = value_from<int64_t>(value / 3);
        break;
    case 4:
        if (!cache.measures.empty()) cache.measures[entry] = float_from(value);
        break;
    default: {
        // Move the border between two voxels.
        const size_t v = 1 + where % (cache.first.size() - 1);
        if (v + 1 < cache.first.size())
            cache.first[v] = std::clamp(uint64_t(value), cache.first[v - 1], cache.first[v + 1]);
    }
    }
}

void sample(const LightCache& cache) {
    const World2x2& w = world();
    const ReadTable table(cache, w.space, w.posed.lights(), {1}, w.workers);
    SampleConfig config;
    config.read.max_depth = std::min(cache.header.max_depth, 4);
    config.blur_metres = cache.header.blur;
    Progress quiet;
    fuzz::check_picture(sample_frame(w.posed, w.camera, table, nullptr, nullptr,
                                     fresh_seeds(1, 0, 2, 2), config, w.workers, quiet)
                            .image,
                        "Linespace");
}

void use(const std::string& path) {
    const LightCache cache = read_cache(path);
    fuzz::refuse_or([&] { (void)merged(cache, cache, "twice"); });
    LightCache other = cache;
    const uint64_t end = other.header.photons.back().end;
    if (end < UINT64_MAX - 9) {
        other.header.photons = {{end, end + 9}};
        fuzz::refuse_or([&] { sample(merged(cache, other, "sum")); });
    }
    fuzz::refuse_or([&] { sample(cache); });
}

// The writer trusts its caller; keep to the shapes it is promised.
bool is_writable(const LightCache& cache) {
    const auto& voxels = cache.header.voxels;
    return voxels[0] > 0 && voxels[1] > 0 && voxels[2] > 0 &&
           uint64_t(voxels[0]) * uint64_t(voxels[1]) < 1000 &&
           cache.header.voxel_count() + 1 == cache.first.size() &&
           cache.measures.empty() == (cache.header.estimator != Estimator::energy);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    constexpr std::array<uint8_t, 4> kMagic = {0x76, 0x2f, 0x31, 0x01};
    if (size >= 4 && std::memcmp(data, kMagic.data(), 4) == 0) {
        const std::string& path = fuzz::scratch_file({data, size});
        fuzz::refuse_or([&] { use(path); });
        return 0;
    }
    LightCache cache = world().good;
    for (; size >= 6; data += 6, size -= 6)
        edit(cache, data[0], uint32_t(data[1]) | uint32_t(data[2]) << 8,
             uint32_t(data[3]) | uint32_t(data[4]) << 8 | uint32_t(data[5]) << 16);
    if (cache.header.estimator != Estimator::energy) cache.measures.clear();
    if (!is_writable(cache)) return 0;
    const std::string& path = fuzz::scratch_file({});
    fuzz::refuse_or([&] {
        write_cache(path, cache);
        use(path);
    });
    return 0;
}
