#include "image/exr_threads.h"

#include "image/image_file.h"

#include <OpenEXR/ImfThreading.h>

#include <atomic>

namespace ql {

namespace {

std::atomic<int> g_threads = 1; // the pool that it is for is the process's too

} // namespace

void set_image_threads(int threads) {
    g_threads = threads;
}

void start_exr_threads() {
    // With none of its own the library works in the thread that calls it.
    const int wanted = g_threads > 1 ? g_threads.load() : 0;
    if (Imf::globalThreadCount() != wanted) Imf::setGlobalThreadCount(wanted);
}

} // namespace ql
