// Lines through a voxel, with weights in the invariant measure cos_a cos_b / r^2 dA_a dA_b.
//
// Points are of a low-discrepancy sequence that is shifted by a hash of voxel and shaft: Roberts,
// "The unreasonable effectiveness of quasirandom sequences" (2018), in four dimensions. Lines come
// in blocks, in the coordinates of the voxel, whose corners are 0 and 1; light goes from the entry
// to the exit. Pure functions of their arguments.
#pragma once

#include "base/parallel.h"
#include "linespace/shaft.h"
#include "sampling/random.h"

#include <array>
#include <span>
#include <vector>

namespace ql {

inline constexpr int kLinesPerBlock = 32;

// origin + t direction, t from 0 at the entry to 1 at the exit.
struct LineBlock {
    std::array<float, kLinesPerBlock> ox, oy, oz, dx, dy, dz, weight;
};

// A patch as a rectangle in the coordinates of the voxel.
struct PatchRectangle {
    int axis, axis_u, axis_v;
    float plane;
    float u, v; // lower corner
    V3f low, high;
};

PatchRectangle rectangle_of(int face, int patch, int patches);

// Points of the sequence in four dimensions, shifted; in [0, 1).
class LinePoints {
  public:
    using Block = std::array<std::array<float, kLinesPerBlock>, 4>; // by dimension

    LinePoints(uint32_t voxel, uint32_t number);
    // Points first, first + 1, ...
    void fill(int first, Block& block) const;

  private:
    RandomWords m_shift; // in units of 2^-32
};

// The lines from one patch to another.
class ShaftLines {
  public:
    // number: what tells the sequence of this shaft from others of the voxel.
    ShaftLines(const ShaftEnds& ends, int patches, const V3d& cell, uint32_t voxel,
               uint32_t number);

    V3f low() const { return m_low; } // the box around all lines
    V3f high() const { return m_high; }
    // Lines first, first + 1, ...
    void fill(int first, LineBlock& block) const;

  private:
    void find_shared_edge(const ShaftEnds& ends, int patches);

    LinePoints m_points;
    PatchRectangle m_entry, m_exit;
    V3f m_cell; // its longest side is 1
    V3f m_low, m_high;
    std::array<int, 4> m_edge{}; // 0, or at which end coordinate k meets an edge that both share
};

// Lines through a whole voxel: every weight is 1, and their measure is pi times its surface. They
// are made once for all voxels of a grid, in several sets that voxels draw by lot, so that what a
// set gets wrong in many like voxels is not the same everywhere.
class VoxelLines {
  public:
    struct Block {
        LineBlock lines;
        std::array<uint32_t, kLinesPerBlock> shafts; // directed, where a face is one patch
    };

    VoxelLines(const V3d& cell, int lines_per_set, const Workers& workers);

    double measure() const;
    std::span<const Block> of_voxel(uint32_t voxel) const;

  private:
    void fill(const LinePoints& source, int first, Block& block) const;

    V3d m_cell;
    std::array<double, 6> m_areas; // cumulative
    size_t m_blocks_per_set;
    std::vector<Block> m_blocks;
};

} // namespace ql
