// Reflective shadow maps as images, in the units of the scene.
//
// Channels: Z (metres along the ray from the light; for directional lights from a plane in front of
// the scene), P.X P.Y P.Z (metres), N.X N.Y N.Z (towards the light; of length 1, but for means in
// mips), flux.R flux.G flux.B (watts; without the solid angle W/sr). All are 0 where the light
// meets nothing.
#pragma once

#include "image/image.h"
#include "rsm/gather.h"

namespace ql {

// One part for each map, named by its number and light, then its mips if wanted.
std::vector<Image> map_images(std::span<const ReflectiveShadowMap> maps, const World& world,
                              int light_exponent, FluxMeasure measure, MipUse mips);

} // namespace ql
