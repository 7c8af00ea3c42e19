// Void-and-cluster as Ulichney describes it, step by step and slow: energies from scratch at every
// step, plain searches, and phase 3 on the pixels that are left.
#pragma once

#include "base/array2d.h"

#include <cstdint>
#include <vector>

namespace ql::reference {

Array2D<uint32_t> void_and_cluster(int width, int height, double sigma_px,
                                   const std::vector<uint32_t>& priority);

} // namespace ql::reference
