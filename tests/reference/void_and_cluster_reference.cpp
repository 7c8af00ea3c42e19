#include "reference/void_and_cluster_reference.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ql::reference {

namespace {

struct Search {
    int width, height;
    double sigma_px;
    const std::vector<uint32_t>& priority;

    int64_t weight(int dx, int dy) const {
        const double squared = double(dx * dx + dy * dy);
        return std::llround(16777216 * std::exp(-squared / (2 * sigma_px * sigma_px)));
    }

    // What the pixels of value `which` within the cut-off give to (x, y), all copies counted.
    int64_t energy(const std::vector<int>& pattern, int which, int x, int y) const {
        const int radius = int(std::ceil(5 * sigma_px));
        int64_t sum = 0;
        for (int dy = -radius; dy <= radius; ++dy)
            for (int dx = -radius; dx <= radius; ++dx)
                if (pattern[size_t(wrap(y + dy, height) * width + wrap(x + dx, width))] == which)
                    sum += weight(dx, dy);
        return sum;
    }

    // The pixel of value `where` with the least or most energy of pixels of value `of`.
    size_t least(const std::vector<int>& pattern, int where, int of) const {
        return extreme(pattern, where, of, 1, 1);
    }
    size_t most(const std::vector<int>& pattern, int where, int of, int priority_sign) const {
        return extreme(pattern, where, of, -1, priority_sign);
    }
    size_t extreme(const std::vector<int>& pattern, int where, int of, int sign,
                   int priority_sign) const {
        std::pair<int64_t, int64_t> best = {INT64_MAX, INT64_MAX};
        size_t found = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const size_t i = size_t(y * width + x);
                if (pattern[i] != where) continue;
                const std::pair<int64_t, int64_t> key = {sign * energy(pattern, of, x, y),
                                                         priority_sign * int64_t(priority[i])};
                if (key < best) {
                    best = key;
                    found = i;
                }
            }
        return found;
    }
};

} // namespace

Array2D<uint32_t> void_and_cluster(int width, int height, double sigma_px,
                                   const std::vector<uint32_t>& priority) {
    const Search search{width, height, sigma_px, priority};
    const size_t n = priority.size();
    Array2D<uint32_t> ranks(width, height);
    if (n == 1) return ranks;
    const size_t ones = std::max<size_t>(1, n / 10);
    std::vector<int> pattern(n);
    for (size_t i = 0; i < n; ++i)
        pattern[i] = priority[i] < ones ? 1 : 0;

    // Initial pattern. Ties: the cluster with the highest, the void with the lowest priority.
    while (true) {
        const size_t cluster = search.most(pattern, 1, 1, -1);
        pattern[cluster] = 0;
        const size_t hole = search.least(pattern, 0, 1);
        pattern[hole] = 1;
        if (hole == cluster) break;
    }
    // Phase 1.
    std::vector<int> shrinking = pattern;
    for (size_t rank = ones; rank-- > 0;) {
        const size_t cluster = search.most(shrinking, 1, 1, -1);
        shrinking[cluster] = 0;
        ranks[cluster] = uint32_t(rank);
    }
    // Phase 2, up to one half: the largest void.
    size_t rank = ones;
    for (; rank < n / 2; ++rank) {
        const size_t hole = search.least(pattern, 0, 1);
        pattern[hole] = 1;
        ranks[hole] = uint32_t(rank);
    }
    // Phase 3: the tightest cluster of zeros.
    for (; rank < n; ++rank) {
        const size_t cluster = search.most(pattern, 0, 0, 1);
        pattern[cluster] = 1;
        ranks[cluster] = uint32_t(rank);
    }
    return ranks;
}

} // namespace ql::reference
