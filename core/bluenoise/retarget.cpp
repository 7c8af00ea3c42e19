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

// The seed that a tile's texture brings to a place: where it stands in its tile, as a distance in
// memory from the tile's corner, and how many tiles to the right and down it ends.
struct Arrival {
    uint32_t from;
    int16_t right, down;
};

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

    // What each texture brings to each place, side by side for the textures of a place.
    std::vector<const Array2D<Imath::V2i>*> textures = moves_of_tile;
    std::sort(textures.begin(), textures.end());
    textures.erase(std::unique(textures.begin(), textures.end()), textures.end());
    const size_t count = textures.size();
    std::vector<Arrival> arrivals(size_t(tile_width) * size_t(tile_height) * count);
    workers.for_each(count, [&](size_t k) {
        const Array2D<Imath::V2i> from = sources(*textures[k], mask_offset);
        for (int y = 0; y < tile_height; ++y)
            for (int x = 0; x < tile_width; ++x) {
                const int sx = wrap(x + from(x, y).x, tile_width);
                const int sy = wrap(y + from(x, y).y, tile_height);
                arrivals[(size_t(y) * size_t(tile_width) + size_t(x)) * count + k] = {
                    uint32_t(sy) * uint32_t(width) + uint32_t(sx),
                    int16_t((sx - from(x, y).x - x) / tile_width),
                    int16_t((sy - from(x, y).y - y) / tile_height)};
            }
    });
    int farthest = 0;
    for (const Arrival& arrival : arrivals)
        farthest = std::max({farthest, std::abs(arrival.right), std::abs(arrival.down)});

    // The tiles: their textures, their corners in memory, and the wrapped columns and rows.
    std::vector<uint32_t> texture_of_tile(moves_of_tile.size());
    std::vector<size_t> corner(moves_of_tile.size());
    for (size_t t = 0; t < moves_of_tile.size(); ++t) {
        texture_of_tile[t] =
            uint32_t(std::lower_bound(textures.begin(), textures.end(), moves_of_tile[t]) -
                     textures.begin());
        corner[t] = t / size_t(columns) * size_t(tile_height) * size_t(width) +
                    t % size_t(columns) * size_t(tile_width);
    }
    std::vector<uint32_t> wrapped_column, first_of_row;
    for (int c = -farthest; c < columns + farthest; ++c)
        wrapped_column.push_back(uint32_t(wrap(c, columns)));
    for (int r = -farthest; r < rows + farthest; ++r)
        first_of_row.push_back(uint32_t(wrap(r, rows) * columns));

    // The tiles' seeds for one place meet each other only: places are independent.
    Array2D<uint32_t> result(width, height);
    const uint32_t* const in = seeds.values().data();
    workers.for_each(size_t(tile_height), [&](size_t y) {
        PlaceAssignment place(moves_of_tile.size());
        for (size_t x = 0; x < size_t(tile_width); ++x) {
            const Arrival* const brought = &arrivals[(y * size_t(tile_width) + x) * count];
            place.clear();
            uint32_t tile = 0;
            for (int r = 0; r < rows; ++r)
                for (int c = 0; c < columns; ++c, ++tile) {
                    const Arrival& arrival = brought[texture_of_tile[tile]];
                    place.offer(tile, first_of_row[size_t(r + arrival.down + farthest)] +
                                          wrapped_column[size_t(c + arrival.right + farthest)]);
                }
            const std::vector<uint32_t>& source = place.sources();
            uint32_t* const out = result.values().data() + y * size_t(width) + x;
            for (size_t t = 0; t < source.size(); ++t)
                out[corner[t]] = in[corner[source[t]] + brought[texture_of_tile[source[t]]].from];
        }
    });
    return result;
}

} // namespace ql
