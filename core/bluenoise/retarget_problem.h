// The problem that a retarget texture solves: move every pixel of the mask so that the mask of
// frame t, moved, looks like the mask of frame t + 1.
//
// Find a bijection i -> i + m + d(i) of the tile (toroidal), |d| <= r on each axis, that minimises
//     E = sum_i |M(i) - M(i + m + d(i) + s)|          s: step of the mask, m: motion of the surface
// plus, if wanted, lambda * sum_i |d(i)|^2. Heitz and Belcour 2019, section 4.2; Heinle 2020, 2.2.
// This is a linear assignment problem. Energies are integers in the mask's own steps; costs are
// energies times `cost_units`, so that they are integers with the penalty too. Thread safe: const.
#pragma once

#include "base/array2d.h"
#include "bluenoise/mask_file.h"

#include <Imath/ImathVec.h>

#include <cstdint>
#include <vector>

namespace ql {

struct RetargetConfig {
    Imath::V2i step = {0, 0};   // s, pixels
    Imath::V2i motion = {0, 0}; // m, pixels
    int radius_px = 6;          // r, [0, 60]
    // lambda, in 1/256 of the mask's range per pixel^2; [0, 1000], rounded to 1/1000 of a step.
    double move_penalty = 0;
};

constexpr int kMaxRetargetRadius = 60;
constexpr int kMaxRetargetMove = 120; // radius and motion together: what 8 bits hold

class RetargetProblem {
  public:
    // Errors: ErrorKind::usage for values out of range.
    RetargetProblem(const Mask& mask, const RetargetConfig& config);

    int width() const { return m_source.width(); }
    int height() const { return m_source.height(); }
    size_t size() const { return m_source.size(); }
    uint32_t levels() const { return m_levels; }
    const RetargetConfig& config() const { return m_config; }
    int64_t cost_units() const { return m_cost_units; }
    int64_t penalty() const { return m_penalty; }

    // M(i), and M(j + s): what the pixel at j should hold.
    const Array2D<uint32_t>& source() const { return m_source; }
    const Array2D<uint32_t>& goal() const { return m_goal; }

    // The distinct moves d of an axis: all of [-r, r], or one for each pixel of a narrow tile.
    const std::vector<int>& moves_x() const { return m_moves_x; }
    const std::vector<int>& moves_y() const { return m_moves_y; }
    // Where a pixel of this column (row) gets with moves_x()[k] (moves_y()[k]) and the motion.
    const int* columns(int x) const { return &m_columns[size_t(x) * m_moves_x.size()]; }
    const int* rows(int y) const { return &m_rows[size_t(y) * m_moves_y.size()]; }

    // The pixel where i gets with move d.
    uint32_t target(uint32_t i, const Imath::V2i& d) const;
    int64_t energy(uint32_t i, uint32_t j) const {
        return std::abs(int64_t(m_source[i]) - int64_t(m_goal[j]));
    }
    int64_t cost(uint32_t i, uint32_t j, int dx, int dy) const {
        return m_cost_units * energy(i, j) + m_penalty * (dx * dx + dy * dy);
    }

  private:
    RetargetConfig m_config;
    uint32_t m_levels;
    int64_t m_cost_units = 1;
    int64_t m_penalty = 0;
    Array2D<uint32_t> m_source, m_goal;
    std::vector<int> m_moves_x, m_moves_y, m_columns, m_rows;
};

// d(i) for each pixel, without the motion.
using Moves = Array2D<Imath::V2i>;

struct RetargetReport {
    int64_t energy_initial = 0; // of no moves but the motion
    int64_t energy = 0;
    int64_t cost = 0; // in cost units
    double mean_move_px = 0;
    double max_move_px = 0; // Euclidean
    bool bijection = false;
};

RetargetReport retarget_report(const RetargetProblem& problem, const Moves& moves);

} // namespace ql
