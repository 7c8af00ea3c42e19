#include "shading/alpha.h"

#include "shading/surface_input.h"

#include <algorithm>

namespace ql {

bool MaterialAlphaTest::is_solid(const World& world, uint32_t surface_index, uint32_t primitive,
                                 float u, float v, float random) const {
    const Surface& surface = world.surfaces[surface_index];
    const Scene& scene = *world.scene;
    const Material& material = scene.materials[size_t(surface.material)];
    const Mesh& mesh = scene.meshes[size_t(surface.mesh)];
    const Hit hit{0, u, v, surface_index, primitive, V3f(0, 0, 1)};
    SurfacePoint point;
    detail::add_texture_coordinates(surface, mesh, mesh.triangles[primitive], hit, point);
    // Masks have an alpha of 0 or 1 here.
    return random < alpha_at<true>(scene.textures, material, surface_input(point, point.ng));
}

bool has_alpha(const Scene& scene) {
    return std::any_of(scene.materials.begin(), scene.materials.end(),
                       [](const Material& m) { return m.alpha_mode != AlphaMode::opaque; });
}

} // namespace ql
