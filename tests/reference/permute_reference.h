// The sorting and retargeting passes as Heitz and Belcour write them, pixel by pixel.
#pragma once

#include "base/array2d.h"
#include "bluenoise/mask_file.h"

#include <Imath/ImathVec.h>

#include <cstdint>
#include <vector>

namespace ql::reference {

// 64 x 64, by void and cluster.
Mask blue_mask(double sigma_px);

// Blocks of side B whose lattice starts at `origin`. All intensities of a block must differ, and so
// must its mask values.
Array2D<uint32_t> sorted_seeds(const Array2D<uint32_t>& seeds, const Array2D<float>& intensities,
                               const Array2D<uint32_t>& mask, const Array2D<uint32_t>& surfaces,
                               int block, Imath::V2i origin, Imath::V2i mask_offset);

// The scatter seeds'(x + R((x + o) mod N)) = seeds(x) on the torus of the seeds.
Array2D<uint32_t> retargeted_seeds(const Array2D<uint32_t>& seeds, const Array2D<Imath::V2i>& moves,
                                   Imath::V2i mask_offset);

// A texture for each tile. Of the seeds that are sent to one pixel that of the first tile stays;
// the others, tile by tile, take the same place in their own tile, then those left the first free
// one.
Array2D<uint32_t>
retargeted_seeds_by_tile(const Array2D<uint32_t>& seeds,
                         const std::vector<const Array2D<Imath::V2i>*>& moves_of_tile,
                         Imath::V2i mask_offset);

} // namespace ql::reference
