// Where surfaces go from one frame to the next, as whole pixels: the motion that picks a retarget
// texture. Heinle 2020, section 3.3.
//
// Motions are in pixels, x to the right and y downwards, of a surface point from frame t to t + 1.
// Matrices are OpenEXR's (row vectors): worldToCamera looks along +z, worldToNDC maps to [0, 1]
// with the upper left corner at (0, 0). Not finite: no surface, left out. Pure functions.
#pragma once

#include "base/array2d.h"

#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <vector>

namespace ql {

struct MotionPlanes {
    Array2D<float> x, y;
};

// Motion of what stands still in the world, from the depth along the camera's axis (world units,
// positive) and the matrices of both frames. Errors: ErrorKind::input for singular matrices.
MotionPlanes camera_motion(const Array2D<float>& depth, const Imath::M44f& camera_from_world,
                           const Imath::M44f& ndc_from_world,
                           const Imath::M44f& next_ndc_from_world);

// The mean over the pixels with a motion in a rectangle, rounded and clamped to +-limit on each
// axis; (0, 0) where no pixel has one. Sums run in a fixed order.
struct PixelRect {
    int x0, y0, x1, y1;
};
Imath::V2i mean_motion(const MotionPlanes& motion, const PixelRect& rect, int limit);

} // namespace ql
