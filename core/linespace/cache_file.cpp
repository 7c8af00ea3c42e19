#include "linespace/cache_file.h"

#include "base/error.h"
#include "image/atomic_file.h"
#include "image/deep_image.h"
#include "linespace/cache_digest.h"
#include "linespace/groups.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <optional>

namespace ql {

namespace {

// Order of the channels in the file: by name.
enum ChannelIndex : size_t { kBHi, kBLo, kGHi, kGLo, kRHi, kRLo, kCount, kMeasure };

std::vector<DeepChannel> channels_of(Estimator estimator) {
    using Type = DeepChannel::Type;
    std::vector<DeepChannel> channels = {{"B.hi", Type::uint32}, {"B.lo", Type::uint32},
                                         {"G.hi", Type::uint32}, {"G.lo", Type::uint32},
                                         {"R.hi", Type::uint32}, {"R.lo", Type::uint32},
                                         {"count", Type::uint32}};
    if (estimator == Estimator::energy) channels.push_back({"measure", Type::float32});
    channels.push_back({"shaft", Type::uint32});
    return channels;
}

std::string text_of(const std::vector<PhotonRange>& ranges) {
    std::string text;
    for (const PhotonRange& range : ranges)
        text += fmt::format("{}{}:{}", text.empty() ? "" : ",", range.begin, range.end);
    return text;
}

std::string text_of(const std::vector<int64_t>& values) {
    std::string text;
    for (const int64_t value : values)
        text += fmt::format("{}{}", text.empty() ? "" : ",", value);
    return text;
}

bool is_zero(const std::vector<int64_t>& values) {
    return std::all_of(values.begin(), values.end(), [](int64_t value) { return value == 0; });
}

DeepHeader deep_header(const LightCache& cache, const std::string& date_time) {
    const CacheHeader& h = cache.header;
    DeepHeader header;
    header.width = h.voxels[0];
    header.height = h.voxels[1] * h.voxels[2];
    header.channels = channels_of(h.estimator);
    header.metadata = {
        {"Software", std::string("quietlight")}, // not which tool: merged is like made at once
        {"capDate", date_time},
        {"ql:format", std::string("Linespace cache")},
        {"ql:version", kCacheVersion},
        {"ql:estimator", name_of(h.estimator)},
        {"ql:patches", h.patches},
        {"ql:normal_classes", h.normal_classes},
        {"ql:voxels_x", h.voxels[0]},
        {"ql:voxels_y", h.voxels[1]},
        {"ql:voxels_z", h.voxels[2]},
        {"ql:grid_lower", h.lower},
        {"ql:voxel_size", h.cell},
        {"ql:max_depth", h.max_depth},
        {"ql:branches", h.branches},
        {"ql:seed", fmt::format("{}", h.seed)},
        {"ql:scene_hash", fmt::format("{:016x}", h.scene_hash)},
        {"ql:sum_bits", h.sum_bits},
        {"ql:unit", h.unit},
        {"ql:photons", text_of(h.photons)},
        {"ql:weight_by_order", text_of(h.weight_by_order)},
        {"ql:unclassified", fmt::format("{}", h.unclassified)},
        {"ql:digest", fmt::format("{:016x}", digest_of(cache))}};
    if (h.blur != 0) header.metadata["ql:blur"] = h.blur;
    if (!is_zero(h.caustic_by_order))
        header.metadata["ql:caustic_by_order"] = text_of(h.caustic_by_order);
    return header;
}

template<class T>
T value_of(const DeepHeader& header, const std::string& key) {
    const T* value = header.find<T>(key);
    if (!value) throw input_error("no Linespace cache: no attribute {} of the right type", key);
    return *value;
}

int integer_of(const DeepHeader& header, const std::string& key, int low, int high) {
    const int value = value_of<int>(header, key);
    if (value < low || value > high)
        throw input_error("{} is {}, expected {} to {}", key, value, low, high);
    return value;
}

template<class T>
T number_of(std::string_view text, const std::string& key, int base = 10) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
    if (error != std::errc() || end != text.data() + text.size())
        throw input_error("{} is '{}', expected a number", key, text.substr(0, 40));
    return value;
}

std::vector<std::string_view> split(std::string_view text) {
    std::vector<std::string_view> parts;
    while (!text.empty()) {
        const size_t comma = std::min(text.find(','), text.size());
        parts.push_back(text.substr(0, comma));
        text.remove_prefix(std::min(comma + 1, text.size()));
    }
    return parts;
}

std::vector<PhotonRange> ranges_of(const std::string& text) {
    std::vector<PhotonRange> ranges;
    for (const std::string_view part : split(text)) {
        const size_t colon = part.find(':');
        if (colon == part.npos)
            throw input_error("ql:photons is '{}', expected ranges A:B", text.substr(0, 40));
        const PhotonRange range{number_of<uint64_t>(part.substr(0, colon), "ql:photons"),
                                number_of<uint64_t>(part.substr(colon + 1), "ql:photons")};
        if (range.begin >= range.end || (!ranges.empty() && range.begin <= ranges.back().end))
            throw input_error("ql:photons is '{}', expected sorted ranges", text.substr(0, 40));
        ranges.push_back(range);
    }
    if (ranges.empty()) throw input_error("ql:photons is empty, expected ranges A:B");
    return ranges;
}

V3d checked_vector(const DeepHeader& header, const std::string& key, double least) {
    const V3d v = value_of<V3d>(header, key);
    for (int axis = 0; axis < 3; ++axis)
        if (!std::isfinite(v[axis]) || !(v[axis] > least))
            throw input_error("{} is {} {} {}, expected finite lengths", key, v.x, v.y, v.z);
    return v;
}

// One number for each order of a cache of this depth.
std::vector<int64_t> weights_of(const DeepHeader& header, const std::string& key, int max_depth) {
    const std::string text = value_of<std::string>(header, key);
    std::vector<int64_t> weights;
    for (const std::string_view part : split(text))
        weights.push_back(number_of<int64_t>(part, key));
    if (weights.size() != size_t(max_depth) - 1)
        throw input_error("{} has {} numbers, expected {}", key, weights.size(), max_depth - 1);
    return weights;
}

CacheHeader cache_header(const DeepHeader& header) {
    if (value_of<std::string>(header, "ql:format") != "Linespace cache")
        throw input_error("no Linespace cache");
    const int version = value_of<int>(header, "ql:version");
    if (version != kCacheVersion)
        throw input_error("a cache of version {}, expected {}", version, kCacheVersion);
    CacheHeader h;
    h.estimator = estimator_named(value_of<std::string>(header, "ql:estimator"));
    h.patches = integer_of(header, "ql:patches", 1, kMaxPatches);
    h.normal_classes = integer_of(header, "ql:normal_classes", 1, 6);
    if (h.normal_classes != 1 && h.normal_classes != 6)
        throw input_error("ql:normal_classes is {}, expected 1 or 6", h.normal_classes);
    const char* const counts[] = {"ql:voxels_x", "ql:voxels_y", "ql:voxels_z"};
    for (size_t axis = 0; axis < 3; ++axis)
        h.voxels[axis] = integer_of(header, counts[axis], 1, kMaxVoxelsPerSide);
    if (h.voxel_count() > kMaxVoxels)
        throw input_error("a grid of {} voxels, expected at most {}", h.voxel_count(), kMaxVoxels);
    if (header.width != h.voxels[0] || header.height != h.voxels[1] * h.voxels[2])
        throw input_error("{} x {} pixels, expected {} x {}", header.width, header.height,
                          h.voxels[0], h.voxels[1] * h.voxels[2]);
    if (header.channels != channels_of(h.estimator))
        throw input_error("channels are not those of a Linespace cache");
    h.lower = checked_vector(header, "ql:grid_lower", -1e300);
    h.cell = checked_vector(header, "ql:voxel_size", 0);
    h.max_depth = integer_of(header, "ql:max_depth", 2, kMaxJoinedDepth);
    h.branches = integer_of(header, "ql:branches", 1, kMaxBranches);
    h.blur = header.metadata.contains("ql:blur") ? value_of<double>(header, "ql:blur") : 0;
    if (!std::isfinite(h.blur) || h.blur < 0)
        throw input_error("ql:blur is {}, expected a radius in metres", h.blur);
    h.seed = number_of<uint64_t>(value_of<std::string>(header, "ql:seed"), "ql:seed");
    h.scene_hash =
        number_of<uint64_t>(value_of<std::string>(header, "ql:scene_hash"), "ql:scene_hash", 16);
    h.sum_bits = integer_of(header, "ql:sum_bits", 1, 62);
    h.unit = value_of<double>(header, "ql:unit");
    if (!std::isfinite(h.unit) || h.unit < 0)
        throw input_error("ql:unit is {}, expected a finite power", h.unit);
    h.photons = ranges_of(value_of<std::string>(header, "ql:photons"));
    h.weight_by_order = weights_of(header, "ql:weight_by_order", h.max_depth);
    h.caustic_by_order.assign(h.weight_by_order.size(), 0);
    if (header.metadata.contains("ql:caustic_by_order"))
        h.caustic_by_order = weights_of(header, "ql:caustic_by_order", h.max_depth);
    h.unclassified =
        number_of<int64_t>(value_of<std::string>(header, "ql:unclassified"), "ql:unclassified");
    return h;
}

uint32_t high_half(int64_t value) {
    return uint32_t(uint64_t(value) >> 32);
}
uint32_t low_half(int64_t value) {
    return uint32_t(uint64_t(value));
}
int64_t from_halves(uint32_t high, uint32_t low) {
    return int64_t(uint64_t{high} << 32 | low);
}

class CacheReader : public DeepReader {
  public:
    LightCache cache;
    uint64_t digest = 0;

    uint64_t on_header(const DeepHeader& header) override {
        cache.header = cache_header(header);
        digest = number_of<uint64_t>(value_of<std::string>(header, "ql:digest"), "ql:digest", 16);
        m_shafts_end = 2 * cache.header.caustics_from();
        m_end = m_shafts_end;
        if (is_measured())
            m_end += ShaftGroups(cache.header.patches, cache.header.normal_classes).size();
        return m_end;
    }

    void on_sample_counts(std::span<const uint32_t> counts, uint64_t total) override {
        m_counts.assign(counts.begin(), counts.end());
        cache.first.assign(counts.size() + 1, 0);
        cache.shafts.reserve(total);
        cache.counts.reserve(total);
        cache.sums.reserve(total);
        if (!is_measured()) return;
        cache.group_first.assign(counts.size() + 1, 0);
        cache.measures.reserve(total);
    }

    void on_row(int y, const DeepRow& row) override {
        const auto width = size_t(cache.header.voxels[0]);
        size_t i = 0;
        for (size_t voxel = size_t(y) * width; voxel < (size_t(y) + 1) * width; ++voxel) {
            DeepRow pixel = row;
            for (std::span<uint32_t>& channel : pixel)
                channel = channel.subspan(i, m_counts[voxel]);
            i += m_counts[voxel];
            const std::span<const uint32_t> numbers = pixel.back();
            check_order(voxel, numbers);
            const auto shafts = size_t(
                std::lower_bound(numbers.begin(), numbers.end(), m_shafts_end) - numbers.begin());
            add_shafts(pixel, shafts);
            for (size_t g = shafts; g < numbers.size(); ++g)
                add_group(pixel, g);
            cache.first[voxel + 1] = cache.size();
            if (is_measured()) cache.group_first[voxel + 1] = cache.groups.size();
        }
    }

  private:
    bool is_measured() const { return cache.header.estimator == Estimator::energy; }

    void check_order(size_t voxel, std::span<const uint32_t> numbers) const {
        for (size_t i = 0; i < numbers.size(); ++i)
            if (numbers[i] >= m_end || (i > 0 && numbers[i] <= numbers[i - 1]))
                throw input_error("damaged: voxel {} has shaft {} out of order", voxel, numbers[i]);
    }

    static float measure_of(const DeepRow& pixel, size_t i) {
        const float measure = std::bit_cast<float>(pixel[kMeasure][i]);
        if (!std::isfinite(measure) || !(measure > 0))
            throw input_error("damaged: measure {} in shaft {}, expected a positive number",
                              measure, pixel.back()[i]);
        return measure;
    }

    void add_group(const DeepRow& pixel, size_t i) {
        for (const size_t channel : {kBHi, kBLo, kGHi, kGLo, kRHi, kRLo, kCount})
            if (pixel[channel][i] != 0)
                throw input_error("damaged: light in group {}", pixel.back()[i] - m_shafts_end);
        cache.groups.push_back(pixel.back()[i] - m_shafts_end);
        cache.group_measures.push_back(measure_of(pixel, i));
    }

    // The first `count` samples of a pixel.
    void add_shafts(const DeepRow& pixel, size_t count) {
        const size_t begin = cache.size();
        const auto append = [&](HugeVector<uint32_t>& to, std::span<const uint32_t> from) {
            to.insert(to.end(), from.begin(), from.begin() + int64_t(count));
        };
        append(cache.shafts, pixel.back());
        append(cache.counts, pixel[kCount]);
        cache.sums.resize(begin + count);
        if (is_measured()) cache.measures.resize(begin + count);
        for (size_t i = 0; i < count; ++i) {
            ShaftSum& sum = cache.sums[begin + i];
            sum = {from_halves(pixel[kRHi][i], pixel[kRLo][i]),
                   from_halves(pixel[kGHi][i], pixel[kGLo][i]),
                   from_halves(pixel[kBHi][i], pixel[kBLo][i])};
            if ((sum[0] | sum[1] | sum[2]) < 0)
                throw input_error("damaged: a negative sum in shaft {}", pixel.back()[i]);
            if (pixel[kCount][i] == 0)
                throw input_error("damaged: no photons in shaft {}", pixel.back()[i]);
            if (is_measured()) cache.measures[begin + i] = measure_of(pixel, i);
        }
    }

    std::vector<uint32_t> m_counts; // samples by voxel
    uint32_t m_shafts_end = 0;      // of the numbers of shafts; groups follow
    uint32_t m_end = 0;
};

void write_shaft(DeepRow& row, size_t i, const LightCache& cache, size_t entry) {
    const ShaftSum& sum = cache.sums[entry];
    row[kRHi][i] = high_half(sum[0]);
    row[kRLo][i] = low_half(sum[0]);
    row[kGHi][i] = high_half(sum[1]);
    row[kGLo][i] = low_half(sum[1]);
    row[kBHi][i] = high_half(sum[2]);
    row[kBLo][i] = low_half(sum[2]);
    row[kCount][i] = cache.counts[entry];
    if (!cache.measures.empty()) row[kMeasure][i] = std::bit_cast<uint32_t>(cache.measures[entry]);
    row.back()[i] = cache.shafts[entry];
}

std::optional<size_t> voxel_of_wrong_groups(const LightCache& cache) {
    if (cache.group_first.empty()) return std::nullopt;
    const ShaftGroups groups(cache.header.patches, cache.header.normal_classes);
    for (size_t v = 0; v + 1 < cache.first.size(); ++v) {
        const auto begin = cache.groups.begin() + int64_t(cache.group_first[v]);
        const auto end = cache.groups.begin() + int64_t(cache.group_first[v + 1]);
        const std::vector<uint32_t> expected = groups.holding(cache.gated_shafts_of(v));
        if (!std::equal(begin, end, expected.begin(), expected.end())) return v;
    }
    return std::nullopt;
}

} // namespace

void write_cache(const std::string& path, const LightCache& cache, const std::string& date_time) {
    const DeepHeader header = deep_header(cache, date_time);
    const auto width = size_t(header.width);
    const bool measured = !cache.group_first.empty();
    const uint32_t shafts_end = 2 * cache.header.caustics_from();
    std::vector<uint32_t> counts(cache.first.size() - 1);
    for (size_t v = 0; v < counts.size(); ++v) {
        counts[v] = uint32_t(cache.first[v + 1] - cache.first[v]);
        if (measured) counts[v] += uint32_t(cache.group_first[v + 1] - cache.group_first[v]);
    }
    write_deep_image(path, header, counts, [&](int y, DeepRow& row) {
        for (const std::span<uint32_t>& channel : row)
            std::fill(channel.begin(), channel.end(), 0);
        size_t i = 0;
        for (size_t voxel = size_t(y) * width; voxel < (size_t(y) + 1) * width; ++voxel) {
            for (size_t entry = cache.first[voxel]; entry < cache.first[voxel + 1]; ++entry, ++i)
                write_shaft(row, i, cache, entry);
            if (!measured) continue;
            for (size_t g = cache.group_first[voxel]; g < cache.group_first[voxel + 1]; ++g, ++i) {
                row[kMeasure][i] = std::bit_cast<uint32_t>(cache.group_measures[g]);
                row.back()[i] = shafts_end + cache.groups[g];
            }
        }
    });
}

LightCache read_cache(const std::string& path) {
    CacheReader reader;
    read_deep_image(path, reader);
    const std::string name = input_name(path);
    if (digest_of(reader.cache) != reader.digest)
        throw input_error("{}: damaged: its content does not match its digest", name);
    if (const auto voxel = voxel_of_wrong_groups(reader.cache))
        throw input_error("{}: damaged: the groups of voxel {} are not those of its shafts", name,
                          *voxel);
    return std::move(reader.cache);
}

} // namespace ql
