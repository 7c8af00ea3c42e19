#include "render/camera.h"

#include <algorithm>
#include <cmath>

namespace ql {

namespace {

constexpr double kClearance = 0.01; // of rounding
constexpr double kFar = 4.0;        // nearer cameras need no shift, in reaches
constexpr double kFarthest = 1e12;

} // namespace

PixelCamera::PixelCamera(const Camera& camera, const M44d& world_from_camera,
                         const RenderSpace& space, int width, int height,
                         const Imath::Box3d& bounds)
    : m_space(space), m_orthographic(camera.orthographic), m_width(width), m_height(height) {
    V3d farthest(0);
    for (int axis = 0; axis < 3 && !bounds.isEmpty(); ++axis)
        farthest[axis] = std::max(std::abs(bounds.min[axis]), std::abs(bounds.max[axis]));
    m_reach = std::max(farthest.length(), 1.0) * (1 + kClearance);
    const Affine pose = affine_from(world_from_camera);
    m_eye = pose.translation;
    m_forward = pose.vector({0, 0, -1}).normalized();
    // Orthonormal whatever shear the node chain has: keep the axis, then the upward side.
    const V3d up = pose.vector({0, 1, 0});
    m_right = m_forward.cross(up).normalized();
    m_up = m_right.cross(m_forward);
    const double aspect = double(width) / double(height);
    m_half_height = camera.orthographic ? camera.ymag : std::tan(camera.yfov / 2);
    m_half_width = m_half_height * aspect;
}

Ray PixelCamera::ray(double x, double y) const {
    const double sx = (2 * x / m_width - 1) * m_half_width;
    const double sy = (1 - 2 * y / m_height) * m_half_height;
    V3d origin = m_eye;
    V3d direction = m_forward;
    if (m_orthographic)
        origin += m_right * sx + m_up * sy;
    else
        direction = (m_forward + m_right * sx + m_up * sy).normalized();
    V3d start = m_space.from_world(origin);
    if (start.length2() > kFar * kFar * m_reach * m_reach) {
        const double to_closest = -start.dot(direction);
        start += direction * std::max(0.0, to_closest - m_reach);
        // A ray that passes at such a distance meets nothing; it need not leave float's range.
        if (start.length2() > kFarthest * kFarthest) start *= kFarthest / start.length();
    }
    return {V3f(start), 0, V3f(direction), kInfinity};
}

double PixelCamera::depth(const V3d& world_point) const {
    return (world_point - m_eye).dot(m_forward);
}

PixelCamera::Projection PixelCamera::project(const V3d& world_point) const {
    const V3d p = world_point - m_eye;
    const double z = p.dot(m_forward);
    const double divisor = m_orthographic ? 1 : z;
    const double sx = p.dot(m_right) / (divisor * m_half_width);
    const double sy = p.dot(m_up) / (divisor * m_half_height);
    return {(sx + 1) / 2 * m_width, (1 - sy) / 2 * m_height, z};
}

M44d PixelCamera::camera_from_world() const {
    M44d m;
    const V3d axes[3] = {m_right, m_up, m_forward};
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row)
            m[row][column] = axes[column][row];
        m[3][column] = -m_eye.dot(axes[column]);
    }
    return m;
}

Imath::M44f PixelCamera::world_to_camera() const {
    return Imath::M44f(camera_from_world());
}

Imath::M44f PixelCamera::world_to_ndc() const {
    // x_ndc = (x / (w half_width) + 1) / 2 and y_ndc = (1 - y / (w half_height)) / 2, with w = z
    // for perspective and 1 for orthographic cameras.
    M44d clip;
    clip.makeIdentity();
    clip[0][0] = 0.5 / m_half_width;
    clip[1][1] = -0.5 / m_half_height;
    if (m_orthographic) {
        clip[3][0] = clip[3][1] = 0.5;
    } else {
        clip[2][0] = clip[2][1] = 0.5;
        clip[2][3] = 1;
        clip[3][3] = 0;
    }
    const M44d product = camera_from_world() * clip;
    return Imath::M44f(product);
}

} // namespace ql
