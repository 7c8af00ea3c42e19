#include "rsm/seen_sum.h"

namespace ql {

void SeenSum::trace() {
    m_log.count += m_count;
    if (m_log.rays)
        m_log.rays->insert(m_log.rays->end(), m_rays.begin(), m_rays.begin() + long(m_count));
    const uint32_t blocked = m_scene.occluded({m_rays.data(), m_count}, m_alpha_keys.data());
    for (size_t i = 0; i < m_count; ++i)
        if (!(blocked >> i & 1)) m_sum += V3d(m_lights[i]);
    m_count = 0;
}

} // namespace ql
