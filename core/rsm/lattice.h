// Rank-1 lattices of the unit torus, and shifts within one of their cells.
//
// Korobov 1959; Sloan & Joe, "Lattice Methods for Multiple Integration", 1994. Such a lattice is
// the n points i (1, step) / n modulo 1. Shifted by a side of one of its cells it is the same
// again, so the shifts within a cell reach all sets there are (Cranley & Patterson 1976 shift by
// any vector), each point stays near its place, and an estimate is a smooth periodic function of
// the place in the cell. Thread-safe.
#pragma once

#include "sampling/warp.h"

namespace ql {

// Coordinates in a cell, each in [0, 1).
struct CellPlace {
    float first = 0, second = 0;
    float along = 0; // instead of the two: one number that crosses the cell

    bool operator==(const CellPlace&) const = default;
};

struct LatticeCell {
    V2f first = {1, 0}, second = {0, 1}; // its sides, the shortest two
    V2f along = {1, 0};                  // a point of the lattice, see rank1_lattice

    // In [0, 1)^2.
    V2f shift(const CellPlace& place) const;
};

struct Lattice {
    int step = 0;
    LatticeCell cell;
};

// The lattice whose shortest vector is longest, of those with a step near the golden ratio. Its
// direction `along` turns one number for each pixel, that of a mask, into a shift: the direction
// for which a blur of the image leaves least of the error that is to be expected. n: at least 1.
Lattice rank1_lattice(int n);

} // namespace ql
