#include "distribution/frame_sequence.h"

#include "base/error.h"
#include "bluenoise/sort.h"
#include "sampling/seeds.h"

#include <algorithm>
#include <numeric>

namespace ql {

namespace {

// The channels that the passes look at and that the user did not ask for are taken out again.
void drop_planes(Image& image, uint32_t aovs) {
    const auto drop = [&](std::initializer_list<const char*> names) {
        std::erase_if(image.planes, [&](const Plane<float>& plane) {
            return std::find(names.begin(), names.end(), plane.name) != names.end();
        });
        std::erase_if(image.uint_planes, [&](const Plane<uint32_t>& plane) {
            return std::find(names.begin(), names.end(), plane.name) != names.end();
        });
    };
    if (aovs & kAovMotion) drop({"motion.X", "motion.Y"});
    if (aovs & kAovNormal) drop({"N.X", "N.Y", "N.Z"});
    if (aovs & kAovAlbedo) drop({"albedo.R", "albedo.G", "albedo.B"});
    if (aovs & kAovId) drop({"id"});
}

// A seed for estimate k of a pixel; k = 0 is the fresh seed of the frame.
uint32_t estimate_seed(uint64_t seed, int x, int y, int frame, int k) {
    const uint32_t base = hash32(seed, uint32_t(x), uint32_t(y), uint32_t(frame));
    return k == 0 ? base : hash32(base, uint32_t(x), uint32_t(y), uint32_t(k));
}

} // namespace

FrameSequence::FrameSequence(const SequenceConfig& config, const std::optional<Mask>& mask,
                             std::vector<RetargetTexture> textures, int width, int height)
    : m_config(config), m_width(width), m_height(height) {
    if (config.distribution == Distribution::white) return;
    QL_CHECK(mask.has_value());
    m_config.permute.seed = config.seed;
    if (config.distribution == Distribution::temporal)
        m_permuter.emplace(*mask, std::move(textures), m_config.permute, width, height);
    else
        m_ranks = unique_ranks(mask->values);
}

void FrameSequence::set_seeds(const Array2D<uint32_t>& seeds, int frame) {
    if (m_permuter) {
        m_next_seeds = m_permuter->padded_seeds(seeds, frame);
        return;
    }
    if (seeds.width() < m_width || seeds.height() < m_height)
        throw input_error("{}x{} seeds, expected at least {}x{}", seeds.width(), seeds.height(),
                          m_width, m_height);
    m_next_seeds = Array2D<uint32_t>(m_width, m_height);
    for (int y = 0; y < m_height; ++y)
        std::copy_n(seeds.row(y).begin(), m_width, m_next_seeds.row(y).begin());
}

DitherTile FrameSequence::dither_tile(int frame) const {
    const Imath::V2i offset = mask_offset(m_config.permute.offsets, frame);
    DitherTile tile{m_ranks, offset.x, offset.y,
                    hash32(m_config.seed, 0x64697468u, 0, uint32_t(frame))};
    const uint64_t n = m_ranks.size();
    for (uint32_t& shift : tile.shifts.values())
        shift = uint32_t(((2 * uint64_t(shift) + 1) << 31) / n); // (rank + 1/2) / n of 2^32
    return tile;
}

FrameResult FrameSequence::render_with(const FrameView& view, const Array2D<uint32_t>& seeds,
                                       const RenderConfig& config, const Workers& workers,
                                       Progress& progress) const {
    return render_frame(view.scene, view.camera, seeds, config, &view.next, workers, progress);
}

// Of each pixel's estimates, the seed of the one whose rank is the mask's quantile. spent: takes
// the rays and what was discarded.
Array2D<uint32_t> FrameSequence::quantile_seeds(const FrameView& view, const Workers& workers,
                                                Progress& progress, FrameResult& spent) const {
    const size_t k_count = size_t(m_config.estimates);
    const size_t pixels = size_t(m_width) * size_t(m_height);
    std::vector<float> estimates(pixels * k_count);
    RenderConfig plain = m_config.render;
    plain.aovs = 0;
    Array2D<uint32_t> seeds(m_width, m_height);
    for (int k = 0; k < m_config.estimates; ++k) {
        for (int y = 0; y < m_height; ++y)
            for (int x = 0; x < m_width; ++x)
                seeds(x, y) = estimate_seed(m_config.seed, x, y, view.frame, k);
        const FrameResult result = render_with(view, seeds, plain, workers, progress);
        spent.rays.add(result.rays);
        spent.discarded_samples += result.discarded_samples;
        const Array2D<float> intensity = intensity_plane(result.image, "frame");
        for (size_t i = 0; i < pixels; ++i)
            estimates[i * k_count + size_t(k)] = intensity[i];
    }
    // Estimates are fresh in every frame: after a round of offsets the mask jumps.
    const MaskOffsets& offsets = m_config.permute.offsets;
    const Imath::V2i offset =
        mask_offset(offsets, view.frame) +
        mask_jumps(offsets, view.frame / std::lcm(offsets.width, offsets.height));
    workers.for_each(size_t(m_height), [&](size_t row) {
        const int y = int(row);
        std::vector<int> order(k_count);
        for (int x = 0; x < m_width; ++x) {
            const float* values = &estimates[(row * size_t(m_width) + size_t(x)) * k_count];
            for (size_t k = 0; k < k_count; ++k)
                order[k] = int(k);
            const uint64_t rank =
                m_ranks(wrap(x + offset.x, m_ranks.width()), wrap(y + offset.y, m_ranks.height()));
            const auto at = std::ptrdiff_t(rank * k_count / m_ranks.size());
            // Equal estimates stay in the order of k, which is random.
            std::nth_element(order.begin(), order.begin() + at, order.end(), [&](int a, int b) {
                return values[a] != values[b] ? values[a] < values[b] : a < b;
            });
            seeds(x, y) = estimate_seed(m_config.seed, x, y, view.frame, order[size_t(at)]);
        }
    });
    return seeds;
}

FrameResult FrameSequence::render_temporal(const FrameView& view, const Workers& workers,
                                           Progress& progress) {
    if (m_next_seeds.empty()) m_next_seeds = m_permuter->fresh_seeds(view.frame);
    m_seeds = std::move(m_next_seeds);

    // Render with the guides that the passes need.
    uint32_t guides = 0;
    if (m_config.permute.reproject != ReprojectMode::off) guides |= kAovMotion | kAovId;
    if (m_config.similar == SimilarSurfaces::on) guides |= kAovId | kAovNormal | kAovAlbedo;
    if (m_config.demodulate == Demodulate::on) guides |= kAovAlbedo;
    RenderConfig config = m_config.render;
    config.aovs |= guides;
    FrameResult result =
        render_with(view, m_permuter->visible_seeds(m_seeds), config, workers, progress);

    // Keep what the passes look at.
    m_guides = Guides{view.frame, intensity_plane(result.image, "frame"), std::nullopt, {}};
    if (m_config.demodulate == Demodulate::on)
        m_guides->intensity = demodulated(m_guides->intensity, result.image, "frame");
    if (guides & kAovMotion) m_guides->motion = motion_planes(result.image);
    if (m_config.similar == SimilarSurfaces::on) m_guides->surfaces = surface_numbers(result.image);
    drop_planes(result.image, guides & ~m_config.render.aovs);
    return result;
}

void FrameSequence::prepare_next(const Workers& workers) {
    if (!m_guides) return;
    const FrameGuides guides{&m_guides->intensity, m_guides->motion ? &*m_guides->motion : nullptr,
                             m_guides->surfaces};
    m_next_seeds = m_permuter->next_seeds(m_seeds, m_guides->frame, guides, workers);
    m_guides.reset();
}

FrameResult FrameSequence::render(const FrameView& view, const Workers& workers,
                                  Progress& progress) {
    if (m_config.distribution == Distribution::temporal)
        return render_temporal(view, workers, progress);
    RenderConfig config = m_config.render;
    DitherTile tile;
    if (m_config.distribution == Distribution::dithered) {
        tile = dither_tile(view.frame);
        config.dither = &tile;
    }
    FrameResult spent;
    if (m_config.distribution == Distribution::histogram)
        m_seeds = quantile_seeds(view, workers, progress, spent);
    else if (!m_next_seeds.empty())
        m_seeds = std::move(m_next_seeds);
    else
        m_seeds = fresh_seeds(m_config.seed, view.frame, m_width, m_height);
    m_next_seeds = {};
    FrameResult result = render_with(view, m_seeds, config, workers, progress);
    result.rays.add(spent.rays);
    result.discarded_samples += spent.discarded_samples;
    return result;
}

} // namespace ql
