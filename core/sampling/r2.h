// The R2 sequence: point n has the coordinates frac(n / g) and frac(n / g^2), g the plastic number.
//
// Source: M. Roberts, "The unreasonable effectiveness of quasirandom sequences" (2018).
#pragma once

#include <cstdint>

namespace ql {

// 1 / g and 1 / g^2 in units of 2^-32.
inline constexpr uint32_t kR2StepX = 3242174889u, kR2StepY = 2447445414u;

} // namespace ql
