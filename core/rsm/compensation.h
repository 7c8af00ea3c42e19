// What the bound of the geometry term takes away, brought back by tracing a ray.
//
// Kollig & Keller, "Illumination in the presence of weak singularities", MCQMC 2004: a ray from the
// receiver finds a point y; the light that y reflects counts with weight (G - b)+/G, where b is the
// bounded geometry term of a texel that would lie at y. With maps whose texels are jittered afresh
// for every pass, gather and compensation together are one bounce without bias. Thread-safe.
#pragma once

#include "rsm/gather.h"

namespace ql {

struct CompensationCounts {
    uint64_t nearest = 0;
    uint64_t shadow = 0;
};

class Compensation {
  public:
    Compensation(const EmbreeScene& scene, const Gatherer& gatherer);

    // To be added to the gather's irradiance; from one ray. random: of the pixel and pass.
    V3f irradiance(const Receiver& receiver, const PixelRandom& random,
                   CompensationCounts& counts) const;

  private:
    // Share of the map's light at y, with G and b for x.
    V3f returned(const ReflectiveShadowMap& map, const Receiver& receiver, const Ray& ray,
                 const Hit& hit, uint32_t alpha_key, CompensationCounts& counts) const;

    const EmbreeScene& m_scene;
    const Gatherer& m_gatherer;
};

} // namespace ql
