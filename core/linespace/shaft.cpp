#include "linespace/shaft.h"

#include "base/check.h"

namespace ql {

ShaftEnds shaft_ends(uint32_t directed, int patches) {
    QL_CHECK(directed < directed_shaft_count(patches));
    const auto n2 = uint32_t(patches * patches);
    const uint32_t shaft = directed / 2;
    const int high_patch = int(shaft % n2);
    const int low_patch = int(shaft / n2 % n2);
    int block = int(shaft / n2 / n2);
    int low_face = 0;
    while (block >= 5 - low_face)
        block -= 5 - low_face++;
    const int high_face = low_face + 1 + block;
    if (directed % 2 == 0) return {low_face, low_patch, high_face, high_patch};
    return {high_face, high_patch, low_face, low_patch};
}

} // namespace ql
