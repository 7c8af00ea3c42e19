#include "bluenoise/assignment.h"

#include <algorithm>
#include <limits>
#include <queue>

namespace ql {

namespace {

constexpr uint32_t kNone = UINT32_MAX;
constexpr int64_t kFar = std::numeric_limits<int64_t>::max();

// Calls visit(j, dx, dy) for the targets of pixel i.
template<class Visit>
void for_each_target(const RetargetProblem& problem, uint32_t i, const Visit& visit) {
    const int width = problem.width();
    const int* columns = problem.columns(int(i) % width);
    const int* rows = problem.rows(int(i) / width);
    const std::vector<int>&moves_x = problem.moves_x(), &moves_y = problem.moves_y();
    for (size_t l = 0; l < moves_y.size(); ++l)
        for (size_t k = 0; k < moves_x.size(); ++k)
            visit(uint32_t(rows[l] * width + columns[k]), moves_x[k], moves_y[l]);
}

class Solver {
  public:
    explicit Solver(const RetargetProblem& problem)
        : m_problem(problem), m_prices(problem.size(), kFar), m_target(problem.size(), kNone),
          m_source(problem.size(), kNone), m_move(problem.size(), Imath::V2i(0, 0)),
          m_distance(problem.size(), kFar), m_came_from(problem.size()),
          m_came_move(problem.size(), Imath::V2i(0, 0)), m_done(problem.size(), 0) {}

    Assignment solution() {
        reduce_columns();
        std::vector<uint32_t> free;
        for (uint32_t i = 0; i < m_problem.size(); ++i)
            free.push_back(i);
        for (int pass = 0; pass < kReductionPasses; ++pass)
            free = reduced_rows(free);
        for (const uint32_t i : free)
            augment(i);
        Assignment result{Moves(m_problem.width(), m_problem.height(), {0, 0}), m_prices};
        for (uint32_t i = 0; i < m_problem.size(); ++i)
            result.moves[i] = m_move[i];
        return result;
    }

  private:
    static constexpr int kReductionPasses = 4;

    // Prices so high that each target is just worth it for some pixel.
    void reduce_columns() {
        for (uint32_t i = 0; i < m_problem.size(); ++i)
            for_each_target(m_problem, i, [&](uint32_t j, int dx, int dy) {
                m_prices[j] = std::min(m_prices[j], m_problem.cost(i, j, dx, dy));
            });
    }

    void assign(uint32_t i, uint32_t j, const Imath::V2i& move) {
        m_target[i] = j;
        m_source[j] = i;
        m_move[i] = move;
    }

    // Each free pixel takes its best target, whose price falls to where the second best is as
    // good; who had it before is free again. Returns the pixels that stay free.
    std::vector<uint32_t> reduced_rows(const std::vector<uint32_t>& free) {
        std::vector<uint32_t> left;
        for (uint32_t i : free) {
            while (i != kNone) {
                const uint32_t displaced = bid(i);
                if (displaced == kNone) break;
                if (!m_bid_gained) {
                    left.push_back(displaced);
                    break;
                }
                i = displaced;
            }
        }
        return left;
    }

    // Returns the pixel that is free after pixel i took a target.
    uint32_t bid(uint32_t i) {
        int64_t best = kFar, second = kFar;
        uint32_t best_j = kNone, second_j = kNone;
        Imath::V2i best_move(0, 0), second_move(0, 0);
        for_each_target(m_problem, i, [&](uint32_t j, int dx, int dy) {
            const int64_t reduced = m_problem.cost(i, j, dx, dy) - m_prices[j];
            if (reduced >= second) return;
            if (reduced < best) {
                second = best;
                second_j = best_j;
                second_move = best_move;
                best = reduced;
                best_j = j;
                best_move = {dx, dy};
            } else {
                second = reduced;
                second_j = j;
                second_move = {dx, dy};
            }
        });
        m_bid_gained = second_j != kNone && second > best;
        if (m_bid_gained) {
            m_prices[best_j] -= second - best;
        } else if (m_source[best_j] != kNone && second_j != kNone) {
            std::swap(best_j, second_j);
            std::swap(best_move, second_move);
        }
        const uint32_t displaced = m_source[best_j];
        if (displaced != kNone) m_target[displaced] = kNone;
        assign(i, best_j, best_move);
        return displaced;
    }

    // Dijkstra's search over reduced costs from pixel i to the nearest target without a pixel;
    // then prices are adapted and the pixels on the way pass their targets on.
    void augment(uint32_t start) {
        const uint32_t end = nearest_free_target(start);
        for (const uint32_t j : m_settled)
            m_prices[j] += m_distance[j] - m_distance[end];
        uint32_t j = end;
        while (true) {
            const uint32_t i = m_came_from[j];
            const uint32_t previous = m_target[i];
            assign(i, j, m_came_move[j]);
            if (i == start) break;
            j = previous;
        }
        for (const uint32_t touched : m_touched) {
            m_distance[touched] = kFar;
            m_done[touched] = 0;
        }
        m_touched.clear();
        m_settled.clear();
    }

    uint32_t nearest_free_target(uint32_t start) {
        m_queue = {};
        m_level.clear();
        uint32_t found = relax(start, 0, 0);
        while (found == kNone) {
            const uint32_t j = next_target();
            if (m_source[j] == kNone) return j;
            m_settled.push_back(j);
            const uint32_t i = m_source[j];
            // The assigned pixel's own arc is tight: what it pays now is its reduced cost.
            const int64_t own = m_problem.cost(i, j, m_move[i].x, m_move[i].y) - m_prices[j];
            found = relax(i, m_distance[j] - own, m_distance[j]);
        }
        return found;
    }

    // The unsettled target of least distance.
    uint32_t next_target() {
        while (true) {
            uint32_t j;
            if (!m_level.empty()) {
                j = m_level.back();
                m_level.pop_back();
            } else {
                j = m_queue.top().second;
                m_queue.pop();
            }
            if (m_done[j]) continue;
            m_done[j] = 1;
            return j;
        }
    }

    // Offers the targets of pixel i at distance base + reduced cost. `now` is the distance that
    // is settled; a free target at that distance ends the search and is returned.
    uint32_t relax(uint32_t i, int64_t base, int64_t now) {
        const bool first = m_touched.empty();
        uint32_t found = kNone;
        for_each_target(m_problem, i, [&](uint32_t j, int dx, int dy) {
            const int64_t distance = base + m_problem.cost(i, j, dx, dy) - m_prices[j];
            if (distance >= m_distance[j]) return;
            if (m_distance[j] == kFar) m_touched.push_back(j);
            m_distance[j] = distance;
            m_came_from[j] = i;
            m_came_move[j] = {dx, dy};
            if (!first && distance == now) {
                if (m_source[j] == kNone) found = j;
                m_level.push_back(j);
            } else {
                m_queue.emplace(distance, j);
            }
        });
        return found;
    }

    using Entry = std::pair<int64_t, uint32_t>;
    const RetargetProblem& m_problem;
    std::vector<int64_t> m_prices;
    std::vector<uint32_t> m_target, m_source; // pixel -> target and back, kNone: free
    std::vector<Imath::V2i> m_move;
    bool m_bid_gained = false;
    // Of the search under way.
    std::vector<int64_t> m_distance;
    std::vector<uint32_t> m_came_from;
    std::vector<Imath::V2i> m_came_move;
    std::vector<uint8_t> m_done;
    std::vector<uint32_t> m_touched, m_settled, m_level;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> m_queue;
};

} // namespace

Assignment least_cost_assignment(const RetargetProblem& problem) {
    return Solver(problem).solution();
}

int64_t dual_bound(const RetargetProblem& problem, const std::vector<int64_t>& prices) {
    int64_t bound = 0;
    for (uint32_t i = 0; i < problem.size(); ++i) {
        int64_t least = kFar;
        for_each_target(problem, i, [&](uint32_t j, int dx, int dy) {
            least = std::min(least, problem.cost(i, j, dx, dy) - prices[j]);
        });
        bound += least + prices[i];
    }
    return bound;
}

} // namespace ql
