// Lines through a voxel, with weights in the invariant measure cos_a cos_b / r^2 dA_a dA_b.
//
// Points are of a low-discrepancy sequence that is shifted by a hash of voxel and shaft: Roberts,
// "The unreasonable effectiveness of quasirandom sequences" (2018), in four dimensions. Lines come
// in blocks, in the coordinates of the voxel, whose corners are 0 and 1; light goes from the entry
// to the exit. Pure functions of their arguments.
#pragma once

#include "linespace/shaft.h"

#include <array>

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

// A point of the sequence in four dimensions, shifted.
class LinePoints {
  public:
    LinePoints(uint32_t voxel, uint32_t number);
    std::array<float, 4> operator()(int i) const;

  private:
    std::array<float, 4> m_shift;
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
    V3d m_cell;
    V3f m_low, m_high;
    double m_area = 1;           // keeps weights of order 1
    std::array<int, 4> m_edge{}; // 0, or at which end coordinate k meets an edge that both share
};

// All lines of a voxel: every weight is 1, and their measure is pi times its surface.
class VoxelLines {
  public:
    VoxelLines(const V3d& cell, uint32_t voxel);

    double measure() const;
    // shafts: the directed shaft of each line where a face is one patch.
    void fill(int first, LineBlock& block, std::array<uint32_t, kLinesPerBlock>& shafts) const;

  private:
    LinePoints m_points;
    V3d m_cell;
    std::array<double, 6> m_areas; // cumulative
};

} // namespace ql
