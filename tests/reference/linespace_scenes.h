// Small scenes for the tests of the Linespace, made in memory.
#pragma once

#include "scene/scene.h"

#include <vector>

namespace ql::reference {

struct BoxScene {
    double size = 1;      // metres: the box is [0, size]^3
    float albedo = 0.5f;  // of all walls, diffuse
    V3f left = {0, 0, 0}; // albedo of the wall at x = 0, if not black
    V3f emission = {0, 0, 0};
    bool has_plate = false;       // 0.3 wide, 0.06 above the middle of the floor, of no thickness
    bool has_block = false;       // 0.3 wide and high, its underside just below the floor
    bool has_table = false;       // a sheet at half the height, with a gap to the walls
    bool has_false_floor = false; // a second floor at a tenth of the height, walls go on below it
    bool has_mirror = false;      // the wall at z = 0 is a perfect mirror
    float lamp_radius = 0;        // of a sphere that shines with radiance 1, at (0.4, 0.6, 0.5)
    struct PointLight {
        V3d position;     // in units of size
        double intensity; // W/sr at size 1; grows with size^2
    };
    std::vector<PointLight> lights = {};
};

Scene box_scene(const BoxScene& box);

// One square of side 1 about the origin, turned by an arbitrary rotation.
Scene tilted_square();

} // namespace ql::reference
