// Alpha of materials at candidate hits: masks cut at their threshold, blending is by chance.
#pragma once

#include "geometry/embree_scene.h"

namespace ql {

class MaterialAlphaTest : public AlphaTest {
  public:
    bool is_solid(const World& world, uint32_t surface, uint32_t primitive, float u, float v,
                  float random) const override;
};

// Whether any material of the scene needs the test.
bool has_alpha(const Scene& scene);

} // namespace ql
