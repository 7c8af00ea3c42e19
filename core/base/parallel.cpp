#include "base/parallel.h"

#include <sched.h>

#include <algorithm>

namespace ql {

namespace {

int usable_processors() {
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof(set), &set) != 0) return 1;
    return std::max(1, CPU_COUNT(&set));
}

} // namespace

Workers::Workers(int threads)
    : m_count(threads > 0 ? threads : usable_processors()), m_arena(m_count) {}

} // namespace ql
