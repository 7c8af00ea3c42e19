#include "reference/retarget_reference.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace ql::reference {

namespace {

constexpr int64_t kForbidden = INT64_MAX / 100;

// The least cost of moving pixel i to pixel j, over all moves that lead there.
int64_t pair_cost(const Array2D<uint32_t>& mask, const RetargetConfig& config, int64_t cost_units,
                  int64_t penalty, int i, int j) {
    const int width = mask.width(), height = mask.height(), r = config.radius_px;
    int64_t best = kForbidden;
    for (int dy = -r; dy <= r; ++dy)
        for (int dx = -r; dx <= r; ++dx) {
            const int x = i % width + config.motion.x + dx, y = i / width + config.motion.y + dy;
            if (wrap(x, width) != j % width || wrap(y, height) != j / width) continue;
            const int64_t goal =
                mask(wrap(x + config.step.x, width), wrap(y + config.step.y, height));
            const int64_t energy = std::abs(int64_t(mask[size_t(i)]) - goal);
            best = std::min(best, cost_units * energy + penalty * (dx * dx + dy * dy));
        }
    return best;
}

} // namespace

int64_t least_retarget_cost(const Array2D<uint32_t>& mask, const RetargetConfig& config,
                            int64_t cost_units, int64_t penalty) {
    const int n = int(mask.size());
    std::vector<int64_t> costs;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            costs.push_back(pair_cost(mask, config, cost_units, penalty, i, j));
    std::vector<int> target(size_t(n), 0);
    std::iota(target.begin(), target.end(), 0);
    int64_t best = kForbidden;
    do {
        int64_t cost = 0;
        for (int i = 0; i < n; ++i)
            cost = std::min(kForbidden, cost + costs[size_t(i * n + target[size_t(i)])]);
        best = std::min(best, cost);
    } while (std::next_permutation(target.begin(), target.end()));
    return best;
}

} // namespace ql::reference
