// Simulated annealing of a retarget problem: Heinle 2020, section 2.2, and S. Kirkpatrick, C. D.
// Gelatt and M. P. Vecchi, "Optimization by simulated annealing", Science 220, 1983.
//
// State: a bijection, at the start the motion alone. Neighbour: two pixels exchange their targets
// if both accumulated moves stay within the radius. A change of cost dE > 0 is accepted with
// probability exp(-dE / T). One proposal costs O(1). Temperatures are in steps of the mask.
// Runs are functions of the configuration, except those that a time limit cuts or paces.
#pragma once

#include "base/progress.h"
#include "bluenoise/retarget_problem.h"

#include <array>
#include <functional>
#include <vector>

namespace ql {

// T(k) of the k-th temperature, k = 0, 1, ... A temperature lasts for one proposal per pixel, but
// with kirkpatrick for a quasi-equilibrium: a number of accepted exchanges.
//   kirkpatrick, exponential  T0 alpha^k
//   inverse                   T0 / (1 + alpha k)
//   linear                    falls to zero over the steps
//   hajek                     T0 log(2) / log(2 + k): B. Hajek, "Cooling schedules for optimal
//                             annealing", Math. Oper. Res. 13, 1988, is c / log(1 + t). (Heinle
//                             2020, equation 2.9, prints T0 log(1 + t), which heats.)
enum class AnnealSchedule { kirkpatrick, exponential, inverse, linear, hajek };

constexpr int kAcceptanceBins = 16;

// What happened since the row before.
struct AnnealTraceRow {
    int64_t step = 0;
    double temperature = 0;
    int64_t energy = 0;
    double acceptance = 0; // share of all proposals within the radius
    // Share accepted of those with 0 < dE, in equal bins up to 2 (levels - 1); NaN: none proposed.
    std::array<double, kAcceptanceBins> worse = {};
};

struct AnnealConfig {
    AnnealSchedule schedule = AnnealSchedule::kirkpatrick;
    double t0 = 0;                 // steps of the mask; 0: 2 (levels - 1), which accepts everything
    double alpha = 0.95;           // kirkpatrick and exponential: (0, 1); inverse: above 0
    int64_t equilibrium = 0;       // accepted exchanges, 0: five for each pixel
    int64_t steps = 0;             // proposals, 0: ten thousand for each pixel
    double time_limit_seconds = 0; // 0: none; with steps = 0 the schedule is paced to fill it
    uint64_t seed = 0;
    uint64_t stream = 0;        // runs of one seed and different streams are independent
    int trace_rows = 0;         // about so many rows of trace
    int64_t snapshot_every = 0; // proposals
    // Called with the step and the moves so far.
    std::function<void(int64_t, const Moves&)> on_snapshot;
};

// The last temperature that kirkpatrick is paced for, in 1/256 of the mask's range: cold enough
// that next to nothing changes.
constexpr double kFreezingTemperature = 0.3;

struct AnnealResult {
    Moves moves; // the best seen at the end of a temperature
    int64_t steps = 0;
    int64_t accepted = 0;
    double final_temperature = 0;
    bool out_of_time = false;
    std::vector<AnnealTraceRow> trace;
};

// Errors: ErrorKind::usage for values out of range.
AnnealResult anneal(const RetargetProblem& problem, const AnnealConfig& config, Progress& progress);

} // namespace ql
