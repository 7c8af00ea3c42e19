#include "reference/rsm_reference.h"

#include <cmath>
#include <numbers>

namespace ql {

V3d full_irradiance_reference(const EmbreeScene& scene, std::span<const ReflectiveShadowMap> maps,
                              const Receiver& receiver, ShadowTest shadow_test,
                              const GeometryBound& bound) {
    V3d sum(0);
    const V3d x(receiver.position);
    for (const ReflectiveShadowMap& map : maps)
        for (size_t p = 0; p < map.texels.count(); ++p) {
            // Equation 10 of Nilles 2017, with d of unit length.
            const V3d n_p(map.texels.normal(p));
            const V3d way = x - V3d(map.texels.position(p));
            const double distance = way.length();
            if (distance < 1e-9) continue;
            const V3d d = way / distance;
            const double cos_p = n_p.dot(d), cos_x = -V3d(receiver.ns).dot(d);
            if (cos_p * distance < double(kPlaneNoise) || cos_x <= 0) continue;
            if (-V3d(receiver.ng).dot(way) < double(kPlaneNoise)) continue;
            const double disc = double(bound.radius2_scale) * double(map.texels.radius2[p]);
            const double divisor =
                std::max(distance * distance + disc, double(bound.least_distance2));
            if (shadow_test == ShadowTest::on) {
                const V3f from = receiver.position + receiver.ng * receiver.offset;
                const V3f to = map.texels.position(p) + V3f(n_p) * map.texels.offset[p];
                if (scene.is_occluded({from, 0, to - from, 1}, 0)) continue;
            }
            sum += V3d(map.texels.flux(p)) * (cos_p * cos_x / divisor / std::numbers::pi);
        }
    return sum;
}

} // namespace ql
