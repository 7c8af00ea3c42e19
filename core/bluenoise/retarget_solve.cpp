#include "bluenoise/retarget_solve.h"

#include "bluenoise/assignment.h"

#include <algorithm>

namespace ql {

namespace {

RetargetTexture finished_texture(const Mask& mask, const RetargetProblem& problem, Moves moves,
                                 int64_t bound) {
    const RetargetConfig& config = problem.config();
    RetargetTexture texture;
    texture.step = {wrap(config.step.x, problem.width()), wrap(config.step.y, problem.height())};
    texture.motion = config.motion;
    texture.radius_px = config.radius_px;
    texture.mask_hash = mask.hash;
    texture.report = retarget_report(problem, moves);
    texture.energy_bound = double(bound) / double(problem.cost_units());
    QL_CHECK(texture.report.bijection);
    for (Imath::V2i& move : moves.values())
        move += config.motion;
    texture.moves = std::move(moves);
    return texture;
}

} // namespace

std::vector<RetargetConfig> retarget_set(const std::vector<Imath::V2i>& steps, int motions,
                                         const RetargetConfig& base) {
    std::vector<RetargetConfig> configs;
    for (const Imath::V2i& step : steps)
        for (int my = -motions; my <= motions; ++my)
            for (int mx = -motions; mx <= motions; ++mx) {
                configs.push_back(base);
                configs.back().step = step;
                configs.back().motion = {mx, my};
            }
    return configs;
}

RetargetTexture exact_retarget_texture(const Mask& mask, const RetargetConfig& config) {
    const RetargetProblem problem(mask, config);
    Assignment optimum = least_cost_assignment(problem);
    const int64_t bound = dual_bound(problem, optimum.prices);
    RetargetTexture texture = finished_texture(mask, problem, std::move(optimum.moves), bound);
    QL_CHECK_EQ(texture.report.cost, bound);
    return texture;
}

AnnealedTexture annealed_retarget_texture(const Mask& mask, const RetargetConfig& config,
                                          const AnnealConfig& schedule, BoundMode bound_mode,
                                          Progress& progress) {
    const RetargetProblem problem(mask, config);
    AnnealedTexture result;
    result.run = anneal(problem, schedule, progress);
    int64_t bound = 0;
    if (bound_mode == BoundMode::exact)
        bound = dual_bound(problem, least_cost_assignment(problem).prices);
    result.texture = finished_texture(mask, problem, std::move(result.run.moves), bound);
    return result;
}

Array2D<float> moved_tile(const RetargetProblem& problem, const Moves& moves) {
    Array2D<float> tile(problem.width(), problem.height());
    const float top = float(std::max(1u, problem.levels() - 1));
    for (uint32_t i = 0; i < problem.size(); ++i)
        tile[problem.target(i, moves[i])] = float(problem.source()[i]) / top;
    return tile;
}

} // namespace ql
