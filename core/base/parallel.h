// Loops of independent items on a fixed number of threads (oneTBB underneath).
//
// Items may run in any order; results that are added up must be stored per item and added in item
// order afterwards, so that no result depends on the number of threads.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>

namespace ql {

class Workers {
  public:
    // threads: 0 takes every processor in the affinity mask.
    explicit Workers(int threads = 0);

    int count() const { return m_count; }

    // Runs body(i) for i in [0, n). An exception from any item is thrown here.
    template<class Body>
    void for_each(size_t n, const Body& body) const {
        run([&] { tbb::parallel_for(size_t(0), n, body); });
    }

    // Runs work() so that libraries built on TBB (Embree) stay on these threads.
    template<class Work>
    void run(const Work& work) const {
        m_arena.execute(work);
    }

  private:
    int m_count;
    mutable tbb::task_arena m_arena;
};

} // namespace ql
