// What the specialised path tracing kernels buy: the same scene rendered by the kernel that it
// requires and by each larger one, which it gets by materials and meshes that nothing uses.
//     kernel_bench
// 256 x 256 pixels, 4 samples, depth 5, one thread; kernels take turns, medians of nine; the ratio
// to the general kernel (all lobes, textures) is what counts.
#include "reference/scene_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace {

using namespace ql;
using namespace ql::reference;

constexpr int kSide = 256, kSpp = 4, kRuns = 9;

// A mesh that no node places, with normals or colours.
Mesh unused_mesh(uint32_t attribute) {
    Mesh mesh = cube(1, 0);
    if (attribute == kAttributeNormals) mesh.normals.assign(mesh.positions.size(), V3f(0, 0, 1));
    if (attribute == kAttributeTextures) mesh.colors.assign(mesh.positions.size(), V4f(1));
    return mesh;
}

struct Variant {
    Scene scene;
    std::string kernel;
    std::vector<double> seconds = {};
};

double seconds_of(const Scene& scene) {
    RenderConfig config;
    config.spp = kSpp;
    const auto start = std::chrono::steady_clock::now();
    render_scene(scene, cornell_view(kSide), config);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void measure(const char* name, const Scene& needed) {
    std::vector<Variant> variants;
    for (const int lobes : {0, 1, 2})
        for (const uint32_t attribute :
             {0u, uint32_t(kAttributeNormals), uint32_t(kAttributeTextures)}) {
            Scene scene = needed;
            if (lobes == 1) scene.materials.push_back(metal(0.5f));
            if (lobes == 2) scene.materials.push_back(glass(1.5f));
            if (attribute != 0) scene.meshes.push_back(unused_mesh(attribute));
            const std::string kernel = choose_kernel(scene).name;
            const bool known = std::any_of(variants.begin(), variants.end(),
                                           [&](const Variant& v) { return v.kernel == kernel; });
            if (!known) variants.push_back({std::move(scene), kernel});
        }
    for (int run = 0; run < kRuns; ++run)
        for (Variant& variant : variants)
            variant.seconds.push_back(seconds_of(variant.scene));
    for (Variant& variant : variants)
        std::sort(variant.seconds.begin(), variant.seconds.end());
    const double general = variants.back().seconds[kRuns / 2];
    fmt::print("{}\n", name);
    for (const Variant& variant : variants)
        fmt::print("  {:<40} {:6.3f} s   {:5.2f}\n", variant.kernel, variant.seconds[kRuns / 2],
                   variant.seconds[kRuns / 2] / general);
}

} // namespace

int main() {
    measure("Cornell box, diffuse", cornell(lambert(V3f(0.7f)), emitter(V3f(12))));
    measure("Cornell box, block of rough metal", cornell(metal(0.4f), emitter(V3f(12))));
    measure("Cornell box, block of glass", cornell(glass(1.5f), emitter(V3f(12))));
}
