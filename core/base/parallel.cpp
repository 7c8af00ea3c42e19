#include "base/parallel.h"

#include <sched.h>

#include <algorithm>
#include <thread>

namespace ql {

namespace {

int usable_processors() {
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof(set), &set) != 0) // more processors than the set can name
        return std::max(1, int(std::thread::hardware_concurrency()));
    return std::max(1, CPU_COUNT(&set));
}

} // namespace

Workers::Workers(int threads)
    : m_count(threads > 0 ? threads : usable_processors()), m_arena(m_count) {}

} // namespace ql
