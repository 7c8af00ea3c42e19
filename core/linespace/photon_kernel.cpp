#include "linespace/photon_kernel.h"

#include "render/path_tracer.h"

namespace ql {

namespace {

template<uint32_t Lobes>
PhotonTracer tracer(uint32_t attributes) {
    if (attributes & kAttributeTextures)
        return detail::trace_photons<Lobes, kAttributeNormals | kAttributeTextures>;
    if (attributes & kAttributeNormals) return detail::trace_photons<Lobes, kAttributeNormals>;
    return detail::trace_photons<Lobes, 0>;
}

} // namespace

PhotonTracer photon_tracer_for(const Scene& scene) {
    const KernelChoice choice = choose_kernel(scene);
    if (choice.lobes == kLobeDiffuse) return tracer<kLobeDiffuse>(choice.attributes);
    if (choice.lobes == (kLobeDiffuse | kLobeMicrofacet))
        return tracer<kLobeDiffuse | kLobeMicrofacet>(choice.attributes);
    return tracer<kAllLobes>(choice.attributes);
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
