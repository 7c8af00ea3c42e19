// The world handed to Embree: nearest hits and occlusion. The only user of Embree.
//
// Thread-safe once built. Alpha masks cut holes; blended surfaces are met with a probability equal
// to their alpha, decided by a hash of the ray's alpha key and the primitive, so that a path's
// decisions are functions of its own random numbers.
#pragma once

#include "base/parallel.h"
#include "geometry/world.h"

#include <memory>
#include <span>
#include <string>

namespace ql {

// Decides at a candidate hit whether the surface is there. Called only on surfaces whose material
// has an alpha mode other than opaque.
class AlphaTest {
  public:
    virtual ~AlphaTest() = default;
    // u, v: barycentric, on shapes those of the texture; random: uniform in [0, 1).
    virtual bool is_solid(const World& world, uint32_t surface, uint32_t primitive, float u,
                          float v, float random) const = 0;
};

// Rays that are traced together.
inline constexpr size_t kPacketRays = 8;

class EmbreeScene {
  public:
    // alpha_test may be null: then every surface is solid. Both must outlive this object.
    EmbreeScene(const World& world, const AlphaTest* alpha_test, const Workers& workers);
    ~EmbreeScene();
    EmbreeScene(EmbreeScene&&) noexcept;
    EmbreeScene& operator=(EmbreeScene&&) noexcept;

    // The nearest hit with t_near < t <= t_far.
    bool intersect(const Ray& ray, uint32_t alpha_key, Hit& hit) const;
    // Whether anything lies at t_near < t <= t_far.
    bool is_occluded(const Ray& ray, uint32_t alpha_key) const;
    // Bit i: is_occluded(rays[i], alpha_keys[i]). At most kPacketRays; about twice as fast as one
    // by one if they lie close together.
    uint32_t occluded(std::span<const Ray> rays, const uint32_t* alpha_keys) const;

    const World& world() const;

    struct Impl;

  private:
    std::unique_ptr<Impl> m_impl;
};

std::string embree_version(); // with its name

} // namespace ql
