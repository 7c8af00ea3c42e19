#include "bluenoise/retarget.h"

#include <algorithm>
#include <cstdlib>

namespace ql {

namespace {

// For each place of a screen tile where its seed comes from, relative to it.
Array2D<Imath::V2i> sources(const Array2D<Imath::V2i>& moves, const Imath::V2i& mask_offset) {
    const int width = moves.width(), height = moves.height();
    Array2D<Imath::V2i> from(width, height, {0, 0});
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Imath::V2i move =
                moves(wrap(x + mask_offset.x, width), wrap(y + mask_offset.y, height));
            from(wrap(x + move.x, width), wrap(y + move.y, height)) = -move;
        }
    return from;
}

int longest_move(const Array2D<Imath::V2i>& moves) {
    int longest = 0;
    for (const Imath::V2i& move : moves.values())
        longest = std::max({longest, std::abs(move.x), std::abs(move.y)});
    return longest;
}

// One place of a tile: in which tile does each tile's seed for that place end?
class PlaceAssignment {
  public:
    explicit PlaceAssignment(size_t tiles) : m_source(tiles), m_waiting() {}

    void clear() {
        std::fill(m_source.begin(), m_source.end(), kNone);
        m_waiting.clear();
    }
    // Seeds come in the order of the tiles; the first to come stays.
    void offer(uint32_t tile, uint32_t wanted) {
        if (m_source[wanted] == kNone)
            m_source[wanted] = tile;
        else
            m_waiting.push_back(tile);
    }
    // Sends those that wait to their own tile, or to the next that is free.
    const std::vector<uint32_t>& sources() {
        for (uint32_t& tile : m_waiting)
            if (m_source[tile] == kNone) {
                m_source[tile] = tile;
                tile = kNone;
            }
        size_t free = 0;
        for (const uint32_t tile : m_waiting) {
            if (tile == kNone) continue;
            while (m_source[free] != kNone)
                ++free;
            m_source[free] = tile;
        }
        return m_source;
    }

  private:
    static constexpr uint32_t kNone = UINT32_MAX;
    std::vector<uint32_t> m_source; // for each tile the tile whose seed ends there
    std::vector<uint32_t> m_waiting;
};

} // namespace

Array2D<uint32_t> retargeted_seeds(const Array2D<uint32_t>& seeds, const Array2D<Imath::V2i>& moves,
                                   const Imath::V2i& mask_offset, const Workers& workers) {
    const int width = seeds.width(), height = seeds.height();
    const int tile_width = moves.width(), tile_height = moves.height();
    QL_CHECK_EQ(width % tile_width, 0);
    QL_CHECK_EQ(height % tile_height, 0);
    const Array2D<Imath::V2i> from = sources(moves, mask_offset);
    const int margin = longest_move(moves);
    Array2D<uint32_t> result(width, height);

    // Gather: a row of a tile at a time, plain distances in memory where nothing wraps.
    std::vector<std::ptrdiff_t> distances(from.size());
    for (size_t i = 0; i < from.size(); ++i)
        distances[i] = std::ptrdiff_t(from[i].y) * width + from[i].x;
    workers.for_each(size_t(height), [&](size_t row) {
        const int y = int(row);
        uint32_t* out = result.row(y).data();
        const uint32_t* in = seeds.row(y).data();
        const Imath::V2i* from_row = from.row(y % tile_height).data();
        const std::ptrdiff_t* distance = &distances[size_t(y % tile_height) * size_t(tile_width)];
        const bool inner_row = y >= margin && y < height - margin;
        for (int x0 = 0; x0 < width; x0 += tile_width) {
            if (inner_row && x0 >= margin && x0 + tile_width + margin <= width) {
                for (int x = 0; x < tile_width; ++x)
                    out[x0 + x] = in[x0 + x + distance[x]];
                continue;
            }
            for (int x = 0; x < tile_width; ++x)
                out[x0 + x] =
                    seeds(wrap(x0 + x + from_row[x].x, width), wrap(y + from_row[x].y, height));
        }
    });
    return result;
}

Array2D<uint32_t>
retargeted_seeds_by_tile(const Array2D<uint32_t>& seeds,
                         const std::vector<const Array2D<Imath::V2i>*>& moves_of_tile,
                         const Imath::V2i& mask_offset, const Workers& workers) {
    QL_CHECK(!moves_of_tile.empty());
    const int tile_width = moves_of_tile.front()->width();
    const int tile_height = moves_of_tile.front()->height();
    const int width = seeds.width(), height = seeds.height();
    const int columns = width / tile_width, rows = height / tile_height;
    QL_CHECK_EQ(moves_of_tile.size(), size_t(columns) * size_t(rows));

    // Each texture's inverse, once.
    std::vector<const Array2D<Imath::V2i>*> textures = moves_of_tile;
    std::sort(textures.begin(), textures.end());
    textures.erase(std::unique(textures.begin(), textures.end()), textures.end());
    std::vector<Array2D<Imath::V2i>> inverses(textures.size());
    workers.for_each(textures.size(),
                     [&](size_t i) { inverses[i] = sources(*textures[i], mask_offset); });
    std::vector<const Array2D<Imath::V2i>*> from_of_tile;
    for (const auto* moves : moves_of_tile)
        from_of_tile.push_back(&inverses[size_t(
            std::lower_bound(textures.begin(), textures.end(), moves) - textures.begin())]);

    // The tiles' seeds for one place meet each other only: places are independent.
    Array2D<uint32_t> result(width, height);
    workers.for_each(size_t(tile_height), [&](size_t row) {
        const int y = int(row);
        PlaceAssignment place(moves_of_tile.size());
        for (int x = 0; x < tile_width; ++x) {
            place.clear();
            for (int t = 0; t < columns * rows; ++t) {
                // The seed of this tile that comes here stands at (sx, sy) in it
                const Imath::V2i from = (*from_of_tile[size_t(t)])(x, y);
                const int sx = wrap(x + from.x, tile_width), sy = wrap(y + from.y, tile_height);
                const int to_x = wrap(t % columns * tile_width + sx - from.x, width) / tile_width;
                const int to_y =
                    wrap(t / columns * tile_height + sy - from.y, height) / tile_height;
                place.offer(uint32_t(t), uint32_t(to_y * columns + to_x));
            }
            const std::vector<uint32_t>& source = place.sources();
            for (int t = 0; t < columns * rows; ++t) {
                const int s = int(source[size_t(t)]);
                const Imath::V2i from = (*from_of_tile[size_t(s)])(x, y);
                result(t % columns * tile_width + x, t / columns * tile_height + y) =
                    seeds(s % columns * tile_width + wrap(x + from.x, tile_width),
                          s / columns * tile_height + wrap(y + from.y, tile_height));
            }
        }
    });
    return result;
}

} // namespace ql
