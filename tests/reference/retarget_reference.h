// Retarget problems solved by trying every bijection.
#pragma once

#include "bluenoise/retarget_problem.h"

#include <cstdint>

namespace ql::reference {

// The least cost of all bijections within the radius, straight from the definition, in cost units.
// For at most ten pixels.
int64_t least_retarget_cost(const Array2D<uint32_t>& mask, const RetargetConfig& config,
                            int64_t cost_units, int64_t penalty);

} // namespace ql::reference
