// A digest of all that a Linespace cache holds, by which damage shows that its format lets pass.
#pragma once

#include "linespace/cache.h"

namespace ql {

// Of the header's settings and of every entry, in their order.
uint64_t digest_of(const LightCache& cache);

} // namespace ql
