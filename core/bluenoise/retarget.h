// The retargeting pass: seeds that were sorted like the mask of frame t move so that they are
// sorted like that of frame t + 1. Heitz and Belcour 2019, algorithm 2: seeds'(x + R(i)) = seeds(x)
// with i = (x + o(t)) mod N.
//
// The seed texture is padded to whole tiles and wrapped at its padded size: only then is this a
// bijection. The result does not depend on the number of threads.
#pragma once

#include "base/array2d.h"
#include "base/parallel.h"

#include <Imath/ImathVec.h>

#include <cstdint>
#include <vector>

namespace ql {

// The least multiple of the tile's side that holds `size` pixels.
constexpr int padded_size(int size, int tile) {
    return (size + tile - 1) / tile * tile;
}

// moves: R, a bijection of its tile. seeds: whole tiles. mask_offset: o(t).
Array2D<uint32_t> retargeted_seeds(const Array2D<uint32_t>& seeds, const Array2D<Imath::V2i>& moves,
                                   const Imath::V2i& mask_offset, const Workers& workers);

// The same with a texture for each tile of the seed texture (row by row): moves_of_tile points to
// textures of one step and different motions. A seed goes where its tile's texture sends it. Where
// two meet, one stays there, and the other goes to the same place of another tile, its own before
// all: the mask has the same value there, so that seeds stay sorted, and no seed is lost.
Array2D<uint32_t>
retargeted_seeds_by_tile(const Array2D<uint32_t>& seeds,
                         const std::vector<const Array2D<Imath::V2i>*>& moves_of_tile,
                         const Imath::V2i& mask_offset, const Workers& workers);

} // namespace ql
