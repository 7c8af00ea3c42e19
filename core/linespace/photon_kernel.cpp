#include "linespace/photon_kernel.h"

#include "render/path_tracer.h"

namespace ql {

PhotonTracer photon_tracer_for(const Scene& scene) {
    return choose_kernel(scene).lobes == kLobeDiffuse ? detail::trace_photons<kLobeDiffuse>
                                                      : detail::trace_photons<kAllLobes>;
}

void PhotonCounts::add(const PhotonCounts& other) {
    rays += other.rays;
    vertices += other.vertices;
    deposits += other.deposits;
    gated += other.gated;
    discarded += other.discarded;
    unclassified += other.unclassified;
    weight_by_order.resize(std::max(weight_by_order.size(), other.weight_by_order.size()));
    for (size_t i = 0; i < other.weight_by_order.size(); ++i)
        weight_by_order[i] += other.weight_by_order[i];
}

} // namespace ql
