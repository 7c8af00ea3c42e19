// Cameras at work: rays through pixels, and points to pixels.
//
// Pixel coordinates run right and down from the image's upper left corner; pixel (i, j) covers
// [i, i + 1) x [j, j + 1). Depth is measured along the viewing axis, in metres.
#pragma once

#include "geometry/world.h"
#include "image/image.h"

namespace ql {

// Of a scene at time 0 in render space.
inline const Imath::Box3d kUnitBox(V3d(-0.5), V3d(0.5));

class PixelCamera {
  public:
    // world_from_camera may carry scale, which is ignored. bounds: of the posed world.
    PixelCamera(const Camera& camera, const M44d& world_from_camera, const RenderSpace& space,
                int width, int height, const Imath::Box3d& bounds = kUnitBox);

    // In render space, of unit direction. Rays of cameras far outside of these bounds start at the
    // sphere around them, so that float precision is spent on the scene and not on the way to it.
    Ray ray(double x, double y) const;

    struct Projection {
        double x, y;  // pixel coordinates
        double depth; // metres along the axis; not positive: behind the camera
    };
    Projection project(const V3d& world_point) const;
    double depth(const V3d& world_point) const;

    // OpenEXR's standard attributes, Imath convention (row vectors): worldToCamera looks along +z
    // (left-handed); worldToNDC maps to x right and y down in [0, 1], upper left origin.
    Imath::M44f world_to_camera() const;
    Imath::M44f world_to_ndc() const;

  private:
    M44d camera_from_world() const;

    RenderSpace m_space;
    V3d m_eye;                          // world
    V3d m_right, m_up, m_forward;       // unit, world
    double m_half_width, m_half_height; // of the image plane at distance 1, or in metres
    double m_reach;                     // of the world from the origin of render space
    bool m_orthographic;
    int m_width, m_height;
};

} // namespace ql
