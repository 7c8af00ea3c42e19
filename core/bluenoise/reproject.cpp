#include "bluenoise/reproject.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ql {

namespace {

using Imath::M44d;
using Imath::V2d;
using Imath::V3d;

constexpr float kNoMotion = std::numeric_limits<float>::quiet_NaN();

M44d inverse(const M44d& matrix) {
    const double determinant = matrix.determinant();
    if (!std::isfinite(determinant) || determinant == 0)
        throw input_error("a camera matrix without inverse");
    return matrix.gjInverse();
}

// The point in camera space at depth z that appears at `ndc`: two linear equations for x and y.
V3d unprojected(const M44d& k, const V2d& ndc, double z) {
    const double a = k[0][0] - ndc.x * k[0][3], b = k[1][0] - ndc.x * k[1][3];
    const double c = k[0][1] - ndc.y * k[0][3], d = k[1][1] - ndc.y * k[1][3];
    const double e = ndc.x * (z * k[2][3] + k[3][3]) - z * k[2][0] - k[3][0];
    const double f = ndc.y * (z * k[2][3] + k[3][3]) - z * k[2][1] - k[3][1];
    const double determinant = a * d - b * c;
    return {(e * d - b * f) / determinant, (a * f - e * c) / determinant, z};
}

} // namespace

MotionPlanes camera_motion(const Array2D<float>& depth, const Imath::M44f& camera_from_world,
                           const Imath::M44f& ndc_from_world,
                           const Imath::M44f& next_ndc_from_world) {
    const M44d world_from_camera = inverse(M44d(camera_from_world));
    const M44d ndc_from_camera = world_from_camera * M44d(ndc_from_world);
    const M44d next_ndc_from_camera = world_from_camera * M44d(next_ndc_from_world);
    const int width = depth.width(), height = depth.height();
    MotionPlanes motion{Array2D<float>(width, height, kNoMotion),
                        Array2D<float>(width, height, kNoMotion)};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double z = depth(x, y);
            if (!(z > 0) || !std::isfinite(z)) continue;
            const V2d ndc((x + 0.5) / width, (y + 0.5) / height);
            const V3d point = unprojected(ndc_from_camera, ndc, z);
            const M44d& m = next_ndc_from_camera;
            const double w = point.x * m[0][3] + point.y * m[1][3] + point.z * m[2][3] + m[3][3];
            if (!(w > 0)) continue; // behind the next camera
            V3d next;
            m.multVecMatrix(point, next);
            motion.x(x, y) = float((next.x - ndc.x) * width);
            motion.y(x, y) = float((next.y - ndc.y) * height);
        }
    return motion;
}

Imath::V2i mean_motion(const MotionPlanes& motion, const PixelRect& rect, int limit) {
    double sum_x = 0, sum_y = 0;
    int64_t count = 0;
    for (int y = rect.y0; y < rect.y1; ++y)
        for (int x = rect.x0; x < rect.x1; ++x) {
            const float mx = motion.x(x, y), my = motion.y(x, y);
            if (!std::isfinite(mx) || !std::isfinite(my)) continue;
            sum_x += mx;
            sum_y += my;
            ++count;
        }
    if (count == 0) return {0, 0};
    const auto whole = [&](double sum) {
        return int(std::clamp(std::round(sum / double(count)), double(-limit), double(limit)));
    };
    return {whole(sum_x), whole(sum_y)};
}

} // namespace ql
