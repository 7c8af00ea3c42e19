// What lines through a voxel meet there.
//
// Triangles are tested against blocks of lines, in the coordinates of the voxel. Surfaces with an
// alpha count with the share of rays that they stop. The world must outlive it; not to be shared
// between threads.
#pragma once

#include "geometry/embree_scene.h"
#include "linespace/blur.h"
#include "linespace/lines.h"
#include "linespace/open_sides.h"
#include "linespace/voxel_primitives.h"

#include <functional>
#include <span>
#include <vector>

namespace ql {

class LineHits {
  public:
    // alpha_test may be null where no material has an alpha mode.
    LineHits(const World& world, const OpenSides& sides, const AlphaTest* alpha_test,
             const Blur& blur, const VoxelGrid& grid, uint32_t voxel,
             std::span<const Primitive> primitives, int normal_classes);

    // Lines inside this box follow.
    void choose(const V3f& low, const V3f& high);

    // Calls sink(line, normal_class, share) for the first surface of each line, if it takes light,
    // or for every surface that does. share: of the rays that get there and end there.
    using Sink = std::function<void(size_t line, int normal_class, double share)>;
    void visit_first(const LineBlock& lines, const Sink& sink) const;
    void visit_all(const LineBlock& lines, const Sink& sink) const;
    // With a blur: for every surface that takes light, if it comes to the point that the blur moves
    // there past the voxel. The disc's points follow from the numbers of the lines, first, first +
    // 1, ..., and from number; light of closed sides does not count.
    void visit_moved(const LineBlock& lines, uint32_t first, uint32_t number,
                     const Sink& sink) const;
    bool is_blurred() const { return m_blur.is_on(); }
    // Whether light can come along a line of the block at all (open_sides.h); traces a ray.
    bool is_open(const LineBlock& lines, size_t line) const;
    // From here on every line is open.
    void take_as_open() { m_all_open = true; }

  private:
    // A primitive in the coordinates of its voxel.
    struct LocalTriangle {
        V3f corner, edge1, edge2;
        V3f low, high; // its box
        Primitive primitive;
        V3f normal; // edge1 x edge2
        int front_class = -1, back_class = -1;
        float offset = 0; // of rays that start there
        bool has_alpha = false;

        // Class of the normal on the side that a line of direction d comes from; -1 where that side
        // takes no light.
        int class_towards(const V3f& d) const {
            return normal.dot(d) < 0 ? front_class : back_class;
        }
    };
    struct LocalShape {
        const Surface* surface;
        Primitive primitive;
        bool takes_light;
        bool has_alpha;
    };
    struct LineHit {
        float t;
        float alpha;
        int normal_class; // -1: takes no light there
        V3f normal;       // unit, render space, towards where the line comes from
        float offset;     // of rays that start there
    };
    using LineHitLists = std::array<std::vector<LineHit>, kLinesPerBlock>;
    struct Intersections {
        std::array<float, kLinesPerBlock> t, u, v; // t is above 1 where the triangle is missed
    };

    LocalTriangle local_triangle(const Primitive& primitive, int classes) const;
    static void intersect(const LocalTriangle& triangle, const LineBlock& lines, Intersections& at);
    void visit_hits(const LineBlock& lines, bool first_only, const Sink& sink) const;
    LineHitLists hits_of(const LineBlock& lines) const; // sorted
    V3f normal_towards(const LocalTriangle& triangle, const V3d& d) const;
    float alpha_of(const Primitive& primitive, bool has_alpha, float u, float v) const;
    void add_shape_hits(const LocalShape& shape, const LineBlock& lines, size_t i,
                        std::vector<LineHit>& found) const;

    V3d to_render(float x, float y, float z) const;

    const World& m_world;
    const OpenSides& m_sides;
    const AlphaTest* m_alpha_test;
    const Blur& m_blur;
    uint32_t m_voxel;
    V3d m_lower, m_cell;
    int m_classes;
    std::vector<LocalTriangle> m_triangles;
    std::vector<LocalShape> m_shapes;
    bool m_has_alpha = false;
    bool m_all_open = false;
    std::vector<const LocalTriangle*> m_chosen;
};

} // namespace ql
