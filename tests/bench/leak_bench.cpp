// Counts rays that leave closed shapes or meet their own surface, for several ray offsets.
//     leak_bench [RAYS]     rays per shape and offset, 1e8 by default
#include "reference/closed_shapes.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

int main(int argc, char** argv) {
    using namespace ql;
    constexpr int kBounces = 100;
    const double rays = argc > 1 ? std::atof(argv[1]) : 1e8;
    const Workers workers;
    fmt::print("{:<40} {:>8} {:>12} {:>8} {:>10}\n", "shape", "offset", "rays", "leaks",
               "self-hits");
    for (const float factor : {1.0f, 2.0f, 4.0f, 8.0f}) {
        reference::LeakCounts sum;
        for (const reference::ClosedShape& shape : reference::closed_shapes()) {
            const auto counts =
                reference::count_leaks(shape, uint64_t(rays / kBounces), kBounces,
                                       factor * 0x1p-24f / kOffsetFactor, 1, workers);
            fmt::print("{:<40} {:>8} {:>12} {:>8} {:>10}\n", shape.name, factor, counts.rays,
                       counts.leaks, counts.self_hits);
            std::fflush(stdout);
            sum.add(counts);
        }
        fmt::print("{:<40} {:>8} {:>12} {:>8} {:>10}\n", "all", factor, sum.rays, sum.leaks,
                   sum.self_hits);
    }
}
