#include "reference/permute_reference.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <vector>

namespace ql::reference {

namespace {

struct Pixel {
    float intensity;
    uint32_t mask;
    int x, y;
};

int floor_div(int a, int b) {
    return (a - wrap(a, b)) / b;
}

} // namespace

Mask blue_mask(double sigma_px) {
    MaskConfig config;
    config.sigma_px = sigma_px;
    Progress progress;
    Mask mask{mask_ranks(config, progress), 64 * 64, ""};
    mask.hash = mask_hash(mask.values);
    return mask;
}

Array2D<uint32_t> sorted_seeds(const Array2D<uint32_t>& seeds, const Array2D<float>& intensities,
                               const Array2D<uint32_t>& mask, const Array2D<uint32_t>& surfaces,
                               int block, Imath::V2i origin, Imath::V2i mask_offset) {
    // Collect the pixels of each block and surface
    std::map<std::tuple<int, int, uint32_t>, std::vector<Pixel>> groups;
    for (int y = 0; y < intensities.height(); ++y)
        for (int x = 0; x < intensities.width(); ++x) {
            const uint32_t surface = surfaces.empty() ? 0 : surfaces(x, y);
            const uint32_t value =
                mask(wrap(x + mask_offset.x, mask.width()), wrap(y + mask_offset.y, mask.height()));
            groups[{floor_div(x - origin.x, block), floor_div(y - origin.y, block), surface}]
                .push_back({intensities(x, y), value, x, y});
        }
    Array2D<uint32_t> result = seeds;
    for (const auto& [key, pixels] : groups) {
        std::vector<Pixel> by_intensity = pixels, by_mask = pixels;
        std::sort(by_intensity.begin(), by_intensity.end(),
                  [](const Pixel& a, const Pixel& b) { return a.intensity < b.intensity; });
        std::sort(by_mask.begin(), by_mask.end(),
                  [](const Pixel& a, const Pixel& b) { return a.mask < b.mask; });
        for (size_t k = 0; k < pixels.size(); ++k)
            result(by_mask[k].x, by_mask[k].y) = seeds(by_intensity[k].x, by_intensity[k].y);
    }
    return result;
}

Array2D<uint32_t> retargeted_seeds(const Array2D<uint32_t>& seeds, const Array2D<Imath::V2i>& moves,
                                   Imath::V2i mask_offset) {
    Array2D<uint32_t> result(seeds.width(), seeds.height());
    for (int y = 0; y < seeds.height(); ++y)
        for (int x = 0; x < seeds.width(); ++x) {
            const Imath::V2i move = moves(wrap(x + mask_offset.x, moves.width()),
                                          wrap(y + mask_offset.y, moves.height()));
            result(wrap(x + move.x, seeds.width()), wrap(y + move.y, seeds.height())) = seeds(x, y);
        }
    return result;
}

Array2D<uint32_t>
retargeted_seeds_by_tile(const Array2D<uint32_t>& seeds,
                         const std::vector<const Array2D<Imath::V2i>*>& moves_of_tile,
                         Imath::V2i mask_offset) {
    const int tile_width = moves_of_tile[0]->width(), tile_height = moves_of_tile[0]->height();
    const int columns = seeds.width() / tile_width, rows = seeds.height() / tile_height;
    std::map<std::pair<int, int>, uint32_t> placed; // by pixel
    struct Waiting {
        uint32_t seed;
        int tile, x, y; // the place in any tile
    };
    std::vector<Waiting> waiting, homeless;
    for (int tile = 0; tile < columns * rows; ++tile)
        for (int y = 0; y < tile_height; ++y)
            for (int x = 0; x < tile_width; ++x) {
                const int sx = tile % columns * tile_width + x;
                const int sy = tile / columns * tile_height + y;
                const Imath::V2i move = (*moves_of_tile[size_t(tile)])(
                    wrap(sx + mask_offset.x, tile_width), wrap(sy + mask_offset.y, tile_height));
                const int to_x = wrap(sx + move.x, seeds.width());
                const int to_y = wrap(sy + move.y, seeds.height());
                if (!placed.emplace(std::pair(to_x, to_y), seeds(sx, sy)).second)
                    waiting.push_back({seeds(sx, sy), tile, to_x % tile_width, to_y % tile_height});
            }
    const auto place = [&](const Waiting& w, int tile) {
        const int x = tile % columns * tile_width + w.x, y = tile / columns * tile_height + w.y;
        return placed.emplace(std::pair(x, y), w.seed).second;
    };
    for (const Waiting& w : waiting)
        if (!place(w, w.tile)) homeless.push_back(w);
    for (const Waiting& w : homeless) {
        int tile = 0;
        while (!place(w, tile))
            ++tile;
    }
    Array2D<uint32_t> result(seeds.width(), seeds.height());
    for (const auto& [pixel, seed] : placed)
        result(pixel.first, pixel.second) = seed;
    return result;
}

} // namespace ql::reference
