#include "bluenoise/retarget_problem.h"

#include <algorithm>
#include <cmath>

namespace ql {

namespace {

constexpr int64_t kPenaltyUnits = 1000;

std::vector<int> distinct_moves(int radius, int n) {
    std::vector<int> moves;
    const int last = std::min(radius, n / 2);
    const int first = std::max(-radius, last - n + 1);
    for (int d = first; d <= last; ++d)
        moves.push_back(d);
    return moves;
}

std::vector<int> target_table(const std::vector<int>& moves, int motion, int n) {
    std::vector<int> table;
    for (int i = 0; i < n; ++i)
        for (const int d : moves)
            table.push_back(wrap(i + motion + d, n));
    return table;
}

void check(const RetargetConfig& config) {
    if (config.radius_px < 0 || config.radius_px > kMaxRetargetRadius)
        throw usage_error("a radius of {} pixels, expected 0 to {}", config.radius_px,
                          kMaxRetargetRadius);
    const int motion = std::max(std::abs(config.motion.x), std::abs(config.motion.y));
    if (motion + config.radius_px > kMaxRetargetMove)
        throw usage_error("a motion of {},{} and a radius of {}, expected at most {} pixels "
                          "together",
                          config.motion.x, config.motion.y, config.radius_px, kMaxRetargetMove);
    if (!(config.move_penalty >= 0 && config.move_penalty <= 1000))
        throw usage_error("a move penalty of {}, expected 0 to 1000", config.move_penalty);
}

} // namespace

RetargetProblem::RetargetProblem(const Mask& mask, const RetargetConfig& config)
    : m_config(config), m_levels(mask.levels), m_source(mask.values),
      m_goal(mask.values.width(), mask.values.height()) {
    check(config);
    if (config.move_penalty > 0) {
        m_cost_units = kPenaltyUnits;
        m_penalty = std::llround(config.move_penalty * double(m_levels) / 256 * kPenaltyUnits);
    }
    for (int y = 0; y < height(); ++y)
        for (int x = 0; x < width(); ++x)
            m_goal(x, y) =
                m_source(wrap(x + config.step.x, width()), wrap(y + config.step.y, height()));
    m_moves_x = distinct_moves(config.radius_px, width());
    m_moves_y = distinct_moves(config.radius_px, height());
    m_columns = target_table(m_moves_x, config.motion.x, width());
    m_rows = target_table(m_moves_y, config.motion.y, height());
}

uint32_t RetargetProblem::target(uint32_t i, const Imath::V2i& d) const {
    const int x = int(i) % width(), y = int(i) / width();
    return uint32_t(wrap(y + m_config.motion.y + d.y, height()) * width() +
                    wrap(x + m_config.motion.x + d.x, width()));
}

RetargetReport retarget_report(const RetargetProblem& problem, const Moves& moves) {
    RetargetReport report;
    std::vector<uint8_t> reached(problem.size(), 0);
    const int radius = problem.config().radius_px;
    bool in_radius = true;
    for (uint32_t i = 0; i < problem.size(); ++i) {
        const Imath::V2i d = moves[i];
        const uint32_t j = problem.target(i, d);
        reached[j] = 1;
        in_radius = in_radius && std::abs(d.x) <= radius && std::abs(d.y) <= radius;
        report.energy_initial += problem.energy(i, problem.target(i, {0, 0}));
        report.energy += problem.energy(i, j);
        report.cost += problem.cost(i, j, d.x, d.y);
        const double length = std::hypot(d.x, d.y);
        report.mean_move_px += length / double(problem.size());
        report.max_move_px = std::max(report.max_move_px, length);
    }
    report.bijection = in_radius && std::count(reached.begin(), reached.end(), 1) ==
                                        std::ptrdiff_t(problem.size());
    return report;
}

} // namespace ql
