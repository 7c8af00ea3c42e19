// Light that comes straight from the lights, by shadow rays or by the depth layers of the maps.
//
// By map: percentage-closer filtering (Reeves, Salesin, Cook 1987) over 3 x 3 texels, bilinear,
// with a bias that grows with the slope of the surface as in Nilles 2017, listing 3, but in units
// of the texels' own width, so that it needs no scene scale. Thread-safe.
#pragma once

#include "rsm/map.h"

#include <span>

namespace ql {

enum class DirectMode { ray, map };

// Radiance towards the viewer, by all lobes but perfectly specular ones; emission not included.
V3f direct_by_rays(const EmbreeScene& scene, std::span<const MapLight> lights,
                   const RsmSurface& surface, uint32_t alpha_key, uint64_t& shadow_rays);
V3f direct_by_maps(std::span<const ReflectiveShadowMap> maps, const RsmSurface& surface);

} // namespace ql
