// A number that tells scenes apart for caches: equal content, equal hash, on every machine.
//
// Geometry, materials, textures and lights as they are at time 0; not names, cameras or where in
// the node tree something hangs. 64 bits, not proof against intent.
#pragma once

#include "scene/scene.h"

#include <cstdint>

namespace ql {

uint64_t scene_hash(const Scene& scene);

} // namespace ql
