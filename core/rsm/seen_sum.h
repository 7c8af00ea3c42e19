// Adds up the light of the texels that a receiver sees.
//
// Shadow rays are traced in packets, which halves their cost where they lie close together; a sum
// takes its terms in the order in which they come, whatever the packets. One for each receiver and
// thread.
#pragma once

#include "geometry/embree_scene.h"
#include "rsm/geometry_term.h"

#include <vector>

namespace ql {

enum class ShadowTest { on, off };

// Counts shadow rays, and keeps them if asked.
struct ShadowLog {
    uint64_t count = 0;
    std::vector<Ray>* rays = nullptr;
};

class SeenSum {
  public:
    // All must outlive it.
    SeenSum(const EmbreeScene& scene, const Receiver& receiver, ShadowTest test, ShadowLog& log)
        : m_scene(scene), m_origin(receiver.position + receiver.ng * receiver.offset), m_test(test),
          m_log(log) {}

    // Adds `light` if the target is seen.
    void add(const V3f& target, const V3f& light, uint32_t alpha_key) {
        if (m_test == ShadowTest::off) {
            m_sum += V3d(light);
            return;
        }
        m_rays[m_count] = {m_origin, 0, target - m_origin, 1};
        m_lights[m_count] = light;
        m_alpha_keys[m_count] = alpha_key;
        if (++m_count == kPacketRays) trace();
    }

    // Of all that was added.
    V3d sum() {
        if (m_count > 0) trace();
        return m_sum;
    }

  private:
    void trace();

    const EmbreeScene& m_scene;
    V3f m_origin;
    ShadowTest m_test;
    ShadowLog& m_log;
    size_t m_count = 0;
    std::array<Ray, kPacketRays> m_rays;
    std::array<V3f, kPacketRays> m_lights;
    std::array<uint32_t, kPacketRays> m_alpha_keys;
    V3d m_sum{0, 0, 0};
};

} // namespace ql
