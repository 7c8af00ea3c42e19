#include "bluenoise/anneal.h"

#include "sampling/random.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

namespace ql {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int64_t kStepsPerPixel = 10000;
constexpr int64_t kEquilibriumPerPixel = 5;
// Proposals between looks at the clock: about a millisecond.
constexpr int64_t kClockInterval = 50000;

struct Counts {
    int64_t proposed = 0; // within the radius
    int64_t accepted = 0;
    std::array<int64_t, kAcceptanceBins> worse_proposed = {};
    std::array<int64_t, kAcceptanceBins> worse_accepted = {};
};

// A bijection and its cost, changed by exchanges.
class State {
  public:
    explicit State(const RetargetProblem& problem)
        : m_problem(problem), m_radius(problem.config().radius_px), m_units(problem.cost_units()),
          m_penalty(problem.penalty()),
          m_bin_width(std::max(1.0, 2.0 * double(problem.levels() - 1) * double(m_units) /
                                        kAcceptanceBins)),
          m_pixels(problem.size()), m_source(problem.size()) {
        const int width = problem.width(), height = problem.height(), r = m_radius;
        const Imath::V2i motion = problem.config().motion;
        for (int x = -r; x < width + r; ++x)
            m_columns.push_back(wrap(x + motion.x, width));
        for (int y = -r; y < height + r; ++y)
            m_rows.push_back(wrap(y + motion.y, height) * width);
        for (uint32_t i = 0; i < problem.size(); ++i) {
            const uint32_t j = problem.target(i, {0, 0});
            m_pixels[i] = {int32_t(problem.source()[i]), int32_t(problem.goal()[i]), j, 0, 0};
            m_source[j] = i;
            m_energy += problem.energy(i, j);
            m_cost += problem.cost(i, j, 0, 0);
        }
    }

    int64_t energy() const { return m_energy; }
    int64_t cost() const { return m_cost; }

    // Proposes `count` exchanges at a temperature (in cost units). With Count::yes the changes of
    // cost are binned. Stops early once `accept_limit` are accepted; returns the number proposed.
    enum class Count { yes, no };
    template<Count counted>
    int64_t propose(int64_t count, double temperature, int64_t accept_limit, CounterRandom& random,
                    Counts& counts) {
        for (int64_t step = 0; step < count; ++step) {
            if (counts.accepted >= accept_limit) return step;
            propose_one<counted>(temperature, random, counts);
        }
        return count;
    }

    Moves moves() const {
        Moves result(m_problem.width(), m_problem.height(), {0, 0});
        for (size_t i = 0; i < result.size(); ++i)
            result[i] = {m_pixels[i].dx, m_pixels[i].dy};
        return result;
    }

  private:
    struct Pixel {
        int32_t value; // what the pixel brings
        int32_t goal;  // what the pixel wants
        uint32_t target;
        int16_t dx, dy; // to the target, without the motion
    };

    static int32_t difference(int32_t a, int32_t b) { return std::abs(a - b); }

    template<Count counted>
    void propose_one(double temperature, CounterRandom& random, Counts& counts) {
        // Pick a pixel and another target in its box.
        const uint32_t i = scaled(random.next_word(), uint32_t(m_pixels.size()));
        const uint32_t side = uint32_t(2 * m_radius + 1);
        const uint32_t box = scaled(random.next_word(), side * side);
        const int dx = int(box % side) - m_radius, dy = int(box / side) - m_radius;
        Pixel& a = m_pixels[i];
        const int width = m_problem.width();
        const int x = int(i) % width, y = int(i) / width;
        const uint32_t j =
            uint32_t(m_rows[size_t(y + dy + m_radius)] + m_columns[size_t(x + dx + m_radius)]);

        // The pixel that holds it would go where the first one goes now, if that is near enough.
        const uint32_t k = m_source[j];
        Pixel& b = m_pixels[k];
        const int ex = b.dx + a.dx - dx, ey = b.dy + a.dy - dy;
        if (std::abs(ex) > m_radius || std::abs(ey) > m_radius || i == k) return;
        ++counts.proposed;

        // Accept by Metropolis's rule.
        const int32_t goal_a = m_pixels[a.target].goal, goal_b = m_pixels[j].goal;
        const int64_t energy_change = int64_t(difference(a.value, goal_b)) +
                                      difference(b.value, goal_a) - difference(a.value, goal_a) -
                                      difference(b.value, goal_b);
        const int64_t change = m_units * energy_change +
                               m_penalty * (dx * dx + dy * dy + ex * ex + ey * ey - a.dx * a.dx -
                                            a.dy * a.dy - b.dx * b.dx - b.dy * b.dy);
        const bool accept = change <= 0 || is_accepted(double(change) / temperature, random);
        if constexpr (counted == Count::yes) count_worse(change, accept, counts);
        if (!accept) return;
        ++counts.accepted;
        m_source[j] = i;
        m_source[a.target] = k;
        b.target = a.target;
        b.dx = int16_t(ex);
        b.dy = int16_t(ey);
        a.target = j;
        a.dx = int16_t(dx);
        a.dy = int16_t(dy);
        m_energy += energy_change;
        m_cost += change;
    }

    static uint32_t scaled(uint32_t word, uint32_t n) { return uint32_t(uint64_t(word) * n >> 32); }

    static bool is_accepted(double exponent, CounterRandom& random) {
        // exp(-23) is below 2^-32, the least that a word can tell from zero.
        return exponent < 23 && (random.next_word() + 0.5) * 0x1p-32 < std::exp(-exponent);
    }

    void count_worse(int64_t change, bool accept, Counts& counts) const {
        if (change <= 0) return;
        const size_t bin =
            std::min(size_t(double(change) / m_bin_width), size_t(kAcceptanceBins - 1));
        ++counts.worse_proposed[bin];
        counts.worse_accepted[bin] += accept ? 1 : 0;
    }

    const RetargetProblem& m_problem;
    int m_radius;
    int64_t m_units, m_penalty;
    double m_bin_width;
    std::vector<Pixel> m_pixels;
    std::vector<uint32_t> m_source; // the pixel that holds a target
    std::vector<int> m_columns, m_rows;
    int64_t m_energy = 0;
    int64_t m_cost = 0;
};

void check(const AnnealConfig& config) {
    const bool power = config.schedule == AnnealSchedule::kirkpatrick ||
                       config.schedule == AnnealSchedule::exponential;
    if (!(config.alpha > 0) || (power && !(config.alpha < 1)) || !(config.alpha < 1e6))
        throw usage_error("an alpha of {}, expected a number above 0 and, for kirkpatrick and "
                          "exponential, below 1",
                          config.alpha);
    if (!(config.t0 >= 0) || !std::isfinite(config.t0))
        throw usage_error("a T0 of {}, expected a number above 0", config.t0);
    if (config.equilibrium < 0 || config.steps < 0 || config.snapshot_every < 0)
        throw usage_error("a negative number of steps");
    if (!(config.time_limit_seconds >= 0) || !std::isfinite(config.time_limit_seconds))
        throw usage_error("a time limit of {} seconds", config.time_limit_seconds);
}

// One run: temperatures, clock, trace.
class Run {
  public:
    Run(const RetargetProblem& problem, const AnnealConfig& config, Progress& progress)
        : m_problem(problem), m_config(config), m_progress(progress), m_state(problem),
          m_begin(Clock::now()), m_per_pixel(int64_t(problem.size())),
          m_t0(config.t0 > 0 ? config.t0 : 2.0 * std::max(1.0, double(problem.levels() - 1))),
          m_freezing(std::min(kFreezingTemperature * problem.levels() / 256, m_t0)),
          m_steps(config.steps > 0 ? config.steps : kStepsPerPixel * m_per_pixel),
          m_equilibrium(config.equilibrium > 0 ? config.equilibrium
                                               : kEquilibriumPerPixel * m_per_pixel) {
        m_result.moves = m_state.moves();
        m_best_cost = m_state.cost();
        m_next_snapshot = config.snapshot_every;
    }

    AnnealResult result() {
        for (int64_t k = 0; m_result.steps < m_steps && !m_result.out_of_time; ++k) {
            m_result.final_temperature = temperature(k);
            hold(k, m_result.final_temperature);
            keep_best();
        }
        if (m_config.trace_rows > 0) add_row(m_result.final_temperature);
        return std::move(m_result);
    }

  private:
    double temperature(int64_t k) const {
        switch (m_config.schedule) {
        case AnnealSchedule::inverse:
            return m_t0 / (1 + m_config.alpha * double(k));
        case AnnealSchedule::linear: {
            const double last = std::max(1.0, double(m_steps) / double(m_per_pixel));
            return m_t0 * std::max(0.0, 1 - double(k) / last);
        }
        case AnnealSchedule::hajek:
            return m_t0 * std::log(2.0) / std::log(2.0 + double(k));
        case AnnealSchedule::kirkpatrick:
        case AnnealSchedule::exponential:
            break;
        }
        return m_t0 * std::pow(m_config.alpha, double(k));
    }

    // Proposals that the k-th temperature may take. Kirkpatrick: hot temperatures reach their
    // equilibrium early, and what they leave is shared by the colder ones down to freezing.
    int64_t proposals(int64_t k) const {
        if (m_config.schedule != AnnealSchedule::kirkpatrick) return m_per_pixel;
        const double last = std::ceil(std::log(m_freezing / m_t0) / std::log(m_config.alpha));
        const int64_t temperatures_left = std::max(int64_t(1), int64_t(last) - k + 1);
        return std::max(int64_t(1), (m_steps - m_result.steps) / temperatures_left);
    }

    void hold(int64_t k, double temperature) {
        const bool equilibrium = m_config.schedule == AnnealSchedule::kirkpatrick;
        const int64_t first = m_result.steps;
        const int64_t accepted_before = m_since_row.accepted;
        const int64_t accept_limit =
            equilibrium ? accepted_before + std::min(m_equilibrium, INT64_MAX - accepted_before)
                        : INT64_MAX;
        CounterRandom random(m_config.seed, m_config.stream << 40 | uint64_t(k));
        while (!m_result.out_of_time) {
            const int64_t left = std::min(proposals_left(k, first), m_steps - m_result.steps);
            const int64_t batch = std::min(left, batch_limit());
            if (batch <= 0) break;
            const double t = std::max(temperature, 1e-9) * double(m_problem.cost_units());
            const int64_t done = m_config.trace_rows > 0
                                     ? m_state.propose<State::Count::yes>(batch, t, accept_limit,
                                                                          random, m_since_row)
                                     : m_state.propose<State::Count::no>(batch, t, accept_limit,
                                                                         random, m_since_row);
            m_result.steps += done;
            m_progress.advance(uint64_t(done));
            look_at_clock();
            report(temperature);
            if (done < batch) break;
        }
        m_result.accepted += m_since_row.accepted - accepted_before;
    }

    int64_t proposals_left(int64_t k, int64_t first) {
        if (m_config.schedule != AnnealSchedule::kirkpatrick)
            return m_per_pixel - (m_result.steps - first);
        if (m_result.steps == first) m_hold = proposals(k);
        return m_hold - (m_result.steps - first);
    }

    // Up to the next snapshot, row of the trace or look at the clock.
    int64_t batch_limit() const {
        int64_t limit = kClockInterval;
        if (m_config.snapshot_every > 0) limit = std::min(limit, m_next_snapshot - m_result.steps);
        if (m_config.trace_rows > 0) limit = std::min(limit, next_row() - m_result.steps);
        return limit;
    }
    int64_t next_row() const {
        return m_row_step + std::max(int64_t(1), m_steps / std::max(1, m_config.trace_rows));
    }

    void look_at_clock() {
        if (m_config.time_limit_seconds == 0) return;
        const double seconds = std::chrono::duration<double>(Clock::now() - m_begin).count();
        m_result.out_of_time = seconds >= m_config.time_limit_seconds;
        // Pace: as many steps as fit at the speed so far.
        constexpr double kMostSteps = 0x1p61;
        if (m_config.steps == 0 && seconds > 0)
            m_steps = m_result.steps +
                      int64_t(std::min(kMostSteps, double(m_result.steps) / seconds *
                                                       (m_config.time_limit_seconds - seconds)));
    }

    void report(double temperature) {
        if (m_config.snapshot_every > 0 && m_result.steps == m_next_snapshot) {
            m_config.on_snapshot(m_result.steps, m_state.moves());
            m_next_snapshot += m_config.snapshot_every;
        }
        if (m_config.trace_rows > 0 && m_result.steps >= next_row()) add_row(temperature);
    }

    void add_row(double temperature) {
        if (m_result.steps == m_row_step) return;
        const auto share = [](int64_t part, int64_t whole) {
            return whole > 0 ? double(part) / double(whole)
                             : std::numeric_limits<double>::quiet_NaN();
        };
        AnnealTraceRow row{m_result.steps,
                           temperature,
                           m_state.energy(),
                           share(m_since_row.accepted - m_row_accepted, m_since_row.proposed),
                           {}};
        for (size_t bin = 0; bin < kAcceptanceBins; ++bin)
            row.worse[bin] =
                share(m_since_row.worse_accepted[bin], m_since_row.worse_proposed[bin]);
        m_result.trace.push_back(row);
        // The limit of accepted exchanges counts on, everything else begins again.
        const int64_t accepted = m_since_row.accepted;
        m_since_row = {};
        m_since_row.accepted = accepted;
        m_row_accepted = accepted;
        m_row_step = m_result.steps;
    }

    void keep_best() {
        if (m_state.cost() >= m_best_cost) return;
        m_best_cost = m_state.cost();
        m_result.moves = m_state.moves();
    }

    const RetargetProblem& m_problem;
    const AnnealConfig& m_config;
    Progress& m_progress;
    State m_state;
    Clock::time_point m_begin;
    int64_t m_per_pixel;
    double m_t0, m_freezing;
    int64_t m_steps, m_equilibrium;
    int64_t m_hold = 0;
    int64_t m_best_cost = 0;
    int64_t m_next_snapshot = 0;
    int64_t m_row_step = 0, m_row_accepted = 0;
    Counts m_since_row;
    AnnealResult m_result;
};

} // namespace

AnnealResult anneal(const RetargetProblem& problem, const AnnealConfig& config,
                    Progress& progress) {
    check(config);
    if (config.snapshot_every > 0) QL_CHECK(bool(config.on_snapshot));
    return Run(problem, config, progress).result();
}

std::string trace_csv(const std::vector<AnnealTraceRow>& trace) {
    std::string text = "step,temperature,energy,acceptance";
    for (int bin = 1; bin <= kAcceptanceBins; ++bin)
        text += fmt::format(",worse_{}", bin);
    const auto cell = [](double v) { return std::isnan(v) ? "" : fmt::format("{:.6g}", v); };
    for (const AnnealTraceRow& row : trace) {
        text += fmt::format("\n{},{:.6g},{},{}", row.step, row.temperature, row.energy,
                            cell(row.acceptance));
        for (const double share : row.worse)
            text += fmt::format(",{}", cell(share));
    }
    return text + "\n";
}

} // namespace ql
