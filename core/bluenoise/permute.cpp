#include "bluenoise/permute.h"

#include "bluenoise/retarget.h"
#include "bluenoise/sort.h"
#include "sampling/random.h"
#include "sampling/seeds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ql {

namespace {

void check(const PermuteConfig& config) {
    if (config.block_px < 1 || config.block_px > kMaxSortBlock)
        throw usage_error("blocks of {} pixels, expected 1 to {}", config.block_px, kMaxSortBlock);
    if (config.refresh_frames < 0)
        throw usage_error("a refresh every {} frames, expected 0 or more", config.refresh_frames);
}

void check_texture(const RetargetTexture& texture, const Mask& mask) {
    const int width = mask.values.width(), height = mask.values.height();
    if (texture.moves.width() != width || texture.moves.height() != height)
        throw input_error("a retarget texture of {} x {} pixels, the mask has {} x {}",
                          texture.moves.width(), texture.moves.height(), width, height);
    if (texture.mask_hash != mask.hash)
        throw input_error("a retarget texture for the mask {}, this one is {}", texture.mask_hash,
                          mask.hash);
}

uint32_t next_hash(uint32_t hash, uint32_t word) {
    return philox4x32({hash, word, 0, 0}, {0, 0})[0];
}

uint32_t quantized(float value, float step) {
    return uint32_t(int32_t(std::lround(std::clamp(value, -1e6f, 1e6f) / step)));
}

} // namespace

MaskOffsets permute_offsets(OffsetKind kind, const Mask& mask,
                            const std::vector<RetargetTexture>& textures) {
    MaskOffsets offsets = mask_offsets(kind, mask.values.width(), mask.values.height());
    if (textures.empty()) return offsets;
    const Imath::V2i step = textures.front().step;
    if (std::all_of(textures.begin(), textures.end(),
                    [&](const RetargetTexture& texture) { return texture.step == step; }))
        offsets.step = step;
    return offsets;
}

Permuter::Permuter(const Mask& mask, std::vector<RetargetTexture> textures,
                   const PermuteConfig& config, int width, int height)
    : m_config(config), m_width(width), m_height(height),
      m_padded_width(padded_size(width, mask.values.width())),
      m_padded_height(padded_size(height, mask.values.height())),
      m_ranks(unique_ranks(mask.values)), m_textures(std::move(textures)) {
    check(config);
    QL_CHECK(config.offsets.width == mask.values.width() &&
             config.offsets.height == mask.values.height());
    for (const RetargetTexture& texture : m_textures) {
        check_texture(texture, mask);
        m_motion_limit =
            std::max({m_motion_limit, std::abs(texture.motion.x), std::abs(texture.motion.y)});
    }
    if (m_textures.empty()) {
        if (config.reproject != ReprojectMode::off)
            throw usage_error("reprojection needs retarget textures");
        return;
    }
    for (const Imath::V2i& step : retarget_steps(config.offsets))
        if (std::none_of(m_textures.begin(), m_textures.end(), [&](const RetargetTexture& t) {
                return t.step == step && t.motion == Imath::V2i(0, 0);
            }))
            throw input_error("no retarget texture for the step {},{} and the motion 0,0", step.x,
                              step.y);
}

Array2D<uint32_t> Permuter::fresh_seeds(int64_t frame) const {
    return ql::fresh_seeds(m_config.seed, frame, m_padded_width, m_padded_height);
}

Array2D<uint32_t> Permuter::padded_seeds(const Array2D<uint32_t>& seeds, int64_t frame) const {
    if (seeds.width() == m_padded_width && seeds.height() == m_padded_height) return seeds;
    if (seeds.width() != m_width || seeds.height() != m_height)
        throw input_error("{} x {} seeds, expected {} x {} (as the image) or {} x {} (whole tiles)",
                          seeds.width(), seeds.height(), m_width, m_height, m_padded_width,
                          m_padded_height);
    Array2D<uint32_t> padded = fresh_seeds(frame);
    for (int y = 0; y < m_height; ++y)
        std::copy(seeds.row(y).begin(), seeds.row(y).end(), padded.row(y).begin());
    return padded;
}

Array2D<uint32_t> Permuter::visible_seeds(const Array2D<uint32_t>& padded) const {
    Array2D<uint32_t> seeds(m_width, m_height);
    for (int y = 0; y < m_height; ++y)
        std::copy_n(padded.row(y).begin(), m_width, seeds.row(y).begin());
    return seeds;
}

void Permuter::sort(Array2D<uint32_t>& seeds, int64_t frame, const FrameGuides& guides,
                    const Workers& workers) const {
    QL_CHECK(guides.intensity && guides.intensity->width() == m_width &&
             guides.intensity->height() == m_height);
    SortConfig config;
    config.block_px = m_config.block_px;
    config.mask_offset = offset(frame);
    CounterRandom random(m_config.seed, uint64_t(frame));
    config.tie_key = random.next_word();
    if (m_config.block_jitter == BlockJitter::on) {
        const uint32_t side = uint32_t(m_config.block_px);
        config.origin.x = int(bounded(random, side));
        config.origin.y = int(bounded(random, side));
    }
    sort_seeds(seeds, *guides.intensity, m_ranks, guides.surfaces, config, workers);
}

Imath::V2i Permuter::offset(int64_t frame) const {
    const Imath::V2i steps = mask_offset(m_config.offsets, frame);
    if (m_config.refresh_frames == 0) return steps;
    const Imath::V2i jumps = mask_jumps(m_config.offsets, frame / m_config.refresh_frames);
    return {wrap(steps.x + jumps.x, m_config.offsets.width),
            wrap(steps.y + jumps.y, m_config.offsets.height)};
}

// The texture for the frame's step whose motion is nearest.
const RetargetTexture& Permuter::texture(int64_t frame, const Imath::V2i& motion) const {
    const Imath::V2i step = retarget_step(m_config.offsets, frame);
    const RetargetTexture* best = nullptr;
    for (const RetargetTexture& candidate : m_textures) {
        if (candidate.step != step) continue;
        const auto distance = [&](const RetargetTexture& t) {
            return (t.motion - motion).length2();
        };
        if (!best || distance(candidate) < distance(*best)) best = &candidate;
    }
    QL_CHECK(best != nullptr);
    return *best;
}

Imath::V2i Permuter::image_motion(const FrameGuides& guides) const {
    if (m_config.reproject == ReprojectMode::off || !guides.motion) return {0, 0};
    return mean_motion(*guides.motion, {0, 0, m_width, m_height}, m_motion_limit);
}

Array2D<uint32_t> Permuter::retargeted(const Array2D<uint32_t>& seeds, int64_t frame,
                                       const FrameGuides& guides, const Workers& workers) const {
    QL_CHECK(m_config.reproject == ReprojectMode::off || guides.motion);
    if (m_config.reproject != ReprojectMode::tile)
        return retargeted_seeds(seeds, texture(frame, image_motion(guides)).moves, offset(frame),
                                workers);
    const int tile_width = m_ranks.width(), tile_height = m_ranks.height();
    std::vector<const Array2D<Imath::V2i>*> moves_of_tile;
    for (int y = 0; y < m_padded_height; y += tile_height)
        for (int x = 0; x < m_padded_width; x += tile_width) {
            const PixelRect rect{x, y, std::min(x + tile_width, m_width),
                                 std::min(y + tile_height, m_height)};
            const Imath::V2i motion = mean_motion(*guides.motion, rect, m_motion_limit);
            moves_of_tile.push_back(&texture(frame, motion).moves);
        }
    return retargeted_seeds_by_tile(seeds, moves_of_tile, offset(frame), workers);
}

Array2D<uint32_t> Permuter::next_seeds(Array2D<uint32_t> seeds, int64_t frame,
                                       const FrameGuides& guides, const Workers& workers) const {
    QL_CHECK(seeds.width() == m_padded_width && seeds.height() == m_padded_height);
    if (m_config.refresh_frames > 0 && (frame + 1) % m_config.refresh_frames == 0)
        return fresh_seeds(frame + 1);
    if (m_config.block_px > 1) sort(seeds, frame, guides, workers);
    if (!m_textures.empty()) seeds = retargeted(seeds, frame, guides, workers);
    return seeds;
}

Array2D<float> intensity_plane(const Image& image, const std::string& path) {
    const auto *r = image.find("R"), *g = image.find("G"), *b = image.find("B");
    if (!(r && g && b)) {
        if (const auto* y = image.find("Y")) return *y;
        if (image.planes.size() == 1) return image.planes.front().pixels;
        throw input_error("{}: channels {}, expected R, G, B or one", path, image.channel_names());
    }
    Array2D<float> intensity(image.width, image.height);
    for (size_t i = 0; i < intensity.size(); ++i)
        intensity[i] = luminance((*r)[i], (*g)[i], (*b)[i]);
    return intensity;
}

Array2D<float> demodulated(const Array2D<float>& intensity, const Image& guides,
                           const std::string& path) {
    constexpr float kLeastAlbedo = 1e-4f;
    const auto *r = guides.find("albedo.R"), *g = guides.find("albedo.G"),
               *b = guides.find("albedo.B");
    if (!(r && g && b))
        throw input_error("{}: channels {}, expected albedo.R albedo.G albedo.B", path,
                          guides.channel_names());
    Array2D<float> result = intensity;
    for (size_t i = 0; i < result.size(); ++i) {
        const float albedo = luminance((*r)[i], (*g)[i], (*b)[i]);
        if (albedo >= kLeastAlbedo && std::isfinite(albedo)) result[i] /= albedo;
    }
    return result;
}

std::optional<MotionPlanes> motion_planes(const Image& image) {
    const auto *x = image.find("motion.X"), *y = image.find("motion.Y");
    if (!x || !y) return std::nullopt;
    MotionPlanes motion{*x, *y};
    const auto* depth = image.find("Z");
    const auto* id = image.find_uint("id");
    for (size_t i = 0; i < motion.x.size(); ++i)
        if (depth ? !((*depth)[i] > 0) : id && (*id)[i] == 0)
            motion.x[i] = motion.y[i] = std::numeric_limits<float>::quiet_NaN();
    return motion;
}

Array2D<uint32_t> surface_numbers(const Image& guides) {
    constexpr float kNormalStep = 0.25f, kAlbedoStep = 0.125f;
    const auto* id = guides.find_uint("id");
    std::vector<std::pair<const Array2D<float>*, float>> planes;
    for (const char* name : {"N.X", "N.Y", "N.Z"})
        if (const auto* plane = guides.find(name)) planes.emplace_back(plane, kNormalStep);
    for (const char* name : {"albedo.R", "albedo.G", "albedo.B"})
        if (const auto* plane = guides.find(name)) planes.emplace_back(plane, kAlbedoStep);
    if (!id && planes.empty()) return {};
    Array2D<uint32_t> numbers(guides.width, guides.height);
    for (size_t i = 0; i < numbers.size(); ++i) {
        uint32_t hash = id ? next_hash(1, (*id)[i]) : 0;
        for (const auto& [plane, step] : planes)
            hash = next_hash(hash, quantized((*plane)[i], step));
        numbers[i] = hash;
    }
    return numbers;
}

} // namespace ql
