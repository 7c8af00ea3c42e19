#include "bluenoise/void_and_cluster.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>

namespace ql {

namespace {

// A pixel's key, from the top: one bit for "in the pattern", its energy, its priority. No two
// keys are equal, all pixels of the pattern come after all others, and the key names the pixel.
constexpr int kPriorityBits = 24;
constexpr int64_t kPriorityMask = (int64_t(1) << kPriorityBits) - 1;
constexpr int64_t kInPattern = int64_t(1) << 62;
constexpr double kKernelUnits = double(1 << 24);
constexpr int kBlock = 8;

// Winners of blocks of 8 x 8 keys, and of pairs of winners, up to the root.
template<class Better>
class Tournament {
  public:
    explicit Tournament(size_t blocks)
        : m_leaves(std::bit_ceil(blocks)),
          m_nodes(2 * m_leaves, Better()(0, 1) ? INT64_MAX : INT64_MIN), m_stale(blocks, 0) {}

    void mark(uint32_t block) {
        if (m_stale[block]) return;
        m_stale[block] = 1;
        m_list.push_back(block);
    }

    // winner_of(block) is the best key of a block.
    template<class WinnerOf>
    int64_t best(const WinnerOf& winner_of) {
        for (const uint32_t block : m_list) {
            m_stale[block] = 0;
            replace(m_leaves + block, winner_of(block));
        }
        m_list.clear();
        return m_nodes[1];
    }

  private:
    void replace(size_t node, int64_t key) {
        m_nodes[node] = key;
        for (node /= 2; node >= 1; node /= 2) {
            const int64_t winner = std::min(m_nodes[2 * node], m_nodes[2 * node + 1], Better());
            if (winner == m_nodes[node]) return;
            m_nodes[node] = winner;
        }
    }

    size_t m_leaves;
    std::vector<int64_t> m_nodes;
    std::vector<uint8_t> m_stale;
    std::vector<uint32_t> m_list;
};

// A stretch of an axis that does not wrap.
struct Span {
    int begin;        // in the tile
    int kernel_begin; // in the kernel
    int count;
};

// The binary pattern and the energy that its pixels spread.
class EnergyField {
  public:
    EnergyField(const Array2D<int64_t>& kernel, const std::vector<uint32_t>& pixel_of_priority,
                int width, int height)
        : m_kernel(kernel), m_pixel_of_priority(pixel_of_priority),
          m_blocks_x((width + kBlock - 1) / kBlock), m_blocks_y((height + kBlock - 1) / kBlock),
          m_keys(width, height), m_voids(size_t(m_blocks_x) * size_t(m_blocks_y)),
          m_clusters(size_t(m_blocks_x) * size_t(m_blocks_y)) {
        for (uint32_t k = 0; k < pixel_of_priority.size(); ++k)
            m_keys[pixel_of_priority[k]] = k;
        for (uint32_t b = 0; b < uint32_t(m_blocks_x * m_blocks_y); ++b) {
            m_voids.mark(b);
            m_clusters.mark(b);
        }
    }

    void insert(uint32_t pixel) {
        m_keys[pixel] += kInPattern;
        spread(pixel, std::plus<int64_t>());
    }
    void erase(uint32_t pixel) {
        m_keys[pixel] -= kInPattern;
        spread(pixel, std::minus<int64_t>());
    }
    // The pixel outside the pattern with the least energy.
    uint32_t largest_void() {
        return pixel(m_voids.best([&](uint32_t b) { return winner<std::less<int64_t>>(b); }));
    }
    // The pixel of the pattern with the most energy.
    uint32_t tightest_cluster() {
        return pixel(m_clusters.best([&](uint32_t b) { return winner<std::greater<int64_t>>(b); }));
    }

  private:
    uint32_t pixel(int64_t key) const { return m_pixel_of_priority[size_t(key & kPriorityMask)]; }

    template<class Better>
    int64_t winner(uint32_t block) const {
        const int x0 = int(block) % m_blocks_x * kBlock, y0 = int(block) / m_blocks_x * kBlock;
        const int x1 = std::min(x0 + kBlock, m_keys.width());
        const int y1 = std::min(y0 + kBlock, m_keys.height());
        int64_t best = m_keys(x0, y0);
        for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x)
                best = std::min(best, m_keys(x, y), Better());
        return best;
    }

    // The one or two stretches that the kernel covers on an axis of n pixels.
    static std::array<Span, 2> spans(int centre, int kernel_size, int n) {
        const int begin = wrap(centre - kernel_size / 2, n);
        const int first = std::min(kernel_size, n - begin);
        return {Span{begin, 0, first}, Span{0, first, kernel_size - first}};
    }

    template<class Operation>
    void spread(uint32_t pixel, const Operation& operation) {
        const int width = m_keys.width();
        const int x = int(pixel) % width, y = int(pixel) / width;
        for (const Span& rows : spans(y, m_kernel.height(), m_keys.height()))
            for (const Span& columns : spans(x, m_kernel.width(), width)) {
                for (int j = 0; j < rows.count; ++j) {
                    int64_t* keys = &m_keys(columns.begin, rows.begin + j);
                    const int64_t* weights =
                        m_kernel.row(rows.kernel_begin + j).data() + columns.kernel_begin;
                    for (int i = 0; i < columns.count; ++i)
                        keys[i] = operation(keys[i], weights[i] << kPriorityBits);
                }
                mark(rows, columns);
            }
    }

    void mark(const Span& rows, const Span& columns) {
        if (rows.count == 0 || columns.count == 0) return;
        for (int by = rows.begin / kBlock; by <= (rows.begin + rows.count - 1) / kBlock; ++by)
            for (int bx = columns.begin / kBlock;
                 bx <= (columns.begin + columns.count - 1) / kBlock; ++bx) {
                m_voids.mark(uint32_t(by * m_blocks_x + bx));
                m_clusters.mark(uint32_t(by * m_blocks_x + bx));
            }
    }

    const Array2D<int64_t>& m_kernel;
    const std::vector<uint32_t>& m_pixel_of_priority;
    int m_blocks_x, m_blocks_y;
    Array2D<int64_t> m_keys;
    Tournament<std::less<int64_t>> m_voids;
    Tournament<std::greater<int64_t>> m_clusters;
};

// Moves pixels from the tightest cluster to the largest void until that is the same place.
// The pattern's energy falls with every move (ties: the priority does), so this ends.
void spread_evenly(EnergyField& field) {
    while (true) {
        const uint32_t cluster = field.tightest_cluster();
        field.erase(cluster);
        const uint32_t hole = field.largest_void();
        field.insert(hole);
        if (hole == cluster) return;
    }
}

} // namespace

Array2D<int64_t> toroidal_gaussian(int width, int height, double sigma_px) {
    const int radius = int(std::ceil(5 * sigma_px));
    Array2D<int64_t> kernel(std::min(2 * radius + 1, width), std::min(2 * radius + 1, height));
    const int cx = kernel.width() / 2, cy = kernel.height() / 2;
    for (int dy = -radius; dy <= radius; ++dy)
        for (int dx = -radius; dx <= radius; ++dx) {
            const double exponent = (dx * dx + dy * dy) / (2 * sigma_px * sigma_px);
            kernel(wrap(dx + cx, kernel.width()), wrap(dy + cy, kernel.height())) +=
                std::llround(kKernelUnits * std::exp(-exponent));
        }
    return kernel;
}

Array2D<uint32_t> void_and_cluster(int width, int height, double sigma_px,
                                   const std::vector<uint32_t>& priority, Progress& progress) {
    const size_t n = size_t(width) * size_t(height);
    QL_CHECK_EQ(priority.size(), n);
    QL_CHECK(n <= kMaxMaskPixels);
    Array2D<uint32_t> ranks(width, height);
    if (n == 1) return ranks;

    // Start from a tenth of the pixels, and spread them evenly.
    std::vector<uint32_t> pixel_of_priority(n);
    for (uint32_t i = 0; i < n; ++i)
        pixel_of_priority[priority[i]] = i;
    const Array2D<int64_t> kernel = toroidal_gaussian(width, height, sigma_px);
    EnergyField field(kernel, pixel_of_priority, width, height);
    const uint32_t initial = std::max(uint32_t(1), uint32_t(n / 10));
    for (uint32_t k = 0; k < initial; ++k)
        field.insert(pixel_of_priority[k]);
    spread_evenly(field);

    // Phase 1: take clusters out; the last pixel left has rank 0.
    EnergyField shrinking = field;
    for (uint32_t rank = initial; rank-- > 0;) {
        const uint32_t cluster = shrinking.tightest_cluster();
        shrinking.erase(cluster);
        ranks[cluster] = rank;
    }
    progress.advance(initial);

    // Phases 2 and 3: fill voids. Past one half Ulichney takes the tightest cluster of the pixels
    // that are left; their energy is the kernel's sum less that of the pattern: the same pixel.
    for (uint32_t rank = initial; rank < n; ++rank) {
        const uint32_t hole = field.largest_void();
        field.insert(hole);
        ranks[hole] = rank;
        if (rank % 256 == 255) progress.advance(256);
    }
    return ranks;
}

} // namespace ql
