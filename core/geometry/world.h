// The scene posed at one moment, in render space, ready to be asked where rays go.
//
// Render space is (world - centre) * scale, computed in double precision; see geometry/ray.h. It is
// fixed by the scene's bounds at time 0, so that every frame of an animation shares it. Meshes that
// appear once are transformed to render space; meshes that several nodes share are kept once, in a
// unit space of their own, and instanced.
#pragma once

#include "base/parallel.h"
#include "geometry/ray.h"
#include "scene/scene.h"

#include <Imath/ImathBox.h>
#include <Imath/ImathMatrix.h>

#include <array>
#include <memory>
#include <vector>

namespace ql {

struct RenderSpace {
    V3d centre = {0, 0, 0};
    double scale = 1; // render lengths per metre

    V3d from_world(const V3d& p) const { return (p - centre) * scale; }
    V3d to_world(const V3d& p) const { return p / scale + centre; }
};

// x' = linear x + translation, column vectors.
struct Affine {
    Imath::M33d linear; // rows of the matrix
    V3d translation = {0, 0, 0};

    V3d vector(const V3d& v) const;
    V3d point(const V3d& p) const { return vector(p) + translation; }
};

Affine inverse(const Affine& transform);
Affine affine_from(const M44d& row_vector_matrix);
// second after first.
Affine compose(const Affine& second, const Affine& first);

// Vertex positions for Embree, which reads 16 bytes from the last one.
struct Body {
    std::vector<V3f> positions; // one more than there are vertices
};

// One mesh or shape of one node.
struct Surface {
    enum class Kind { triangles, sphere, cone };
    Kind kind = Kind::triangles;
    int node = 0;
    int mesh = -1;                           // into Scene::meshes
    int shape = -1;                          // into Scene::shapes
    const ImplicitShape* implicit = nullptr; // that shape
    int material = 0;
    std::shared_ptr<const Body> body; // triangles: in render space, or shared and in its own space
    bool instanced = false;
    Affine render_from_body;        // instanced triangles, and shapes
    Affine body_from_render;        // shapes
    Imath::M33f render_from_normal; // mesh normals (rows act on column vectors), not normalised
    Imath::M33f render_from_tangent;
    float winding = 1; // -1 where the node mirrors: the front is the other side
    float offset = 0;  // ray offset of instances and shapes, see kOffsetFactor
    // Instances and shapes: at most this many lengths of the body make one render length.
    float body_per_render = 1;
};

struct World {
    const Scene* scene = nullptr;
    RenderSpace space;
    std::vector<M44d> world_from_node;
    std::vector<Surface> surfaces;
    Imath::Box3d bounds; // in render space
};

// What extents a scene may have, in metres, and how far from it things may move, in extents.
inline constexpr double kMinExtent = 1e-15, kMaxExtent = 1e15, kMaxReach = 1e8;

// Bounds of the scene at time 0 decide. A scene without extent stays as it is. Errors:
// ErrorKind::input for an extent out of range.
RenderSpace render_space_of(const Scene& scene, const Workers& workers);

// Errors: ErrorKind::input for a scene that reaches too far.
World pose_world(const Scene& scene, const RenderSpace& space, double time_seconds,
                 const Workers& workers);

// The three corners of a triangle in render space.
std::array<V3f, 3> triangle_corners(const World& world, uint32_t surface, uint32_t primitive);

// How far rays start off that triangle, see kOffsetFactor.
float triangle_offset(const Surface& surface, const std::array<V3f, 3>& corners);

} // namespace ql
