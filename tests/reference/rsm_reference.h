// The gather with every texel, texel by texel and in double precision: slow twin of Gather::full.
#pragma once

#include "rsm/gather.h"

namespace ql {

V3d full_irradiance_reference(const EmbreeScene& scene, std::span<const ReflectiveShadowMap> maps,
                              const Receiver& receiver, ShadowTest shadow_test,
                              const GeometryBound& bound);

} // namespace ql
