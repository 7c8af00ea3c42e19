#include "linespace/blur.h"

#include "geometry/surface_point.h"
#include "linespace/vertex.h"
#include "sampling/warp.h"

namespace ql {

double blur_metres(const BlurRadius& radius, const V3d& cell) {
    return radius.in_voxels ? radius.value * std::min({cell.x, cell.y, cell.z}) : radius.value;
}

V3f Blur::shift(const V3f& position, const V3f& normal, float offset, const V2f& u,
                uint32_t alpha_key) const {
    const V2f disc = square_to_uniform_disk(u) * m_radius;
    const Frame frame = frame_from_normal(normal);
    const V3f moved = frame.s * disc.x + frame.t * disc.y;

    // A short ray down finds out what lies there.
    const float height = 0.02f * m_radius + 2 * offset;
    const Ray down{position + moved + normal * height, 0, -normal, 2 * height};
    Hit hit;
    if (!m_rays->intersect(down, alpha_key, hit)) return V3f(0);
    const World& world = m_rays->world();
    const SurfacePoint there = geometric_point(world, down, hit);
    constexpr float kSameWay = 0.98f; // cosine
    const float cosine = there.ng.dot(normal);
    const bool is_alike = std::abs(cosine) > kSameWay &&
                          takes_light(world.scene->materials[size_t(there.material)]) &&
                          (!m_sides || m_sides->is_open(there.surface, cosine > 0));
    return is_alike ? there.position - position : V3f(0);
}

bool Blur::is_lit_from(const V3f& position, const V3f& normal, float offset, const V3f& w,
                       double distance, uint32_t alpha_key) const {
    const Ray ray{offset_origin(position, normal, offset, w), 0, w, kInfinity};
    Hit hit;
    if (!m_rays->intersect(ray, alpha_key, hit)) return true;
    if (!(double(hit.t) > distance)) return false;
    const SurfacePoint from = geometric_point(m_rays->world(), ray, hit);
    return !m_sides || m_sides->is_open(from.surface, from.ng.dot(w) < 0);
}

} // namespace ql
