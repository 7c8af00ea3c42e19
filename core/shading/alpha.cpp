#include "shading/alpha.h"

#include "shading/surface_input.h"

#include <algorithm>

namespace ql {

bool MaterialAlphaTest::is_solid(const World& world, uint32_t surface, uint32_t primitive, float u,
                                 float v, float random) const {
    const Scene& scene = *world.scene;
    const int material = world.surfaces[surface].material;
    // Masks have an alpha of 0 or 1 here.
    return random < alpha_at(scene.textures, scene.materials[size_t(material)],
                             surface_input_at(world, surface, primitive, u, v));
}

bool has_alpha(const Scene& scene) {
    return std::any_of(scene.materials.begin(), scene.materials.end(),
                       [](const Material& m) { return m.alpha_mode != AlphaMode::opaque; });
}

} // namespace ql
