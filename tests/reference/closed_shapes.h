// Rays inside of closed shapes: none may come out, and none may meet the triangle it starts on.
//
// Each path starts at a random inner point and goes from wall to wall in cosine-distributed
// directions, as paths of a renderer do.
#pragma once

#include "reference/scene_builder.h"

#include <string>

namespace ql::reference {

struct ClosedShape {
    std::string name;
    Scene scene;             // fronts outside; node 0 is the shape, other nodes lie outside of it
    bool flat_walls = false; // no ray from a wall can meet a wall of the same normal
};

// Boxes of one and of many triangles, turned, flattened, small within a large scene, instanced; a
// ball of triangles; a sphere and a cone.
std::vector<ClosedShape> closed_shapes();

struct LeakCounts {
    uint64_t rays = 0;
    uint64_t leaks = 0;     // nothing was hit, or something outside, or a wall from outside
    uint64_t self_hits = 0; // the wall that the ray started on

    void add(const LeakCounts& other);
};

// Offsets are multiplied by offset_share: 1 is what the renderer does.
LeakCounts count_leaks(const ClosedShape& shape, uint64_t paths, int bounces, float offset_share,
                       uint64_t seed, const Workers& workers);

} // namespace ql::reference
