#include "rsm/map_image.h"

#include "render/film.h"

#include <cmath>

namespace ql {

namespace {

// From stored to real flux; directional lights are stored per area, as they are in the scene.
double flux_scale(const ReflectiveShadowMap& map, const World& world, int exponent,
                  FluxMeasure measure) {
    const double s2 = world.space.scale * world.space.scale;
    const bool per_area =
        measure == FluxMeasure::intensity && map.light.kind == Light::Kind::directional;
    return std::ldexp(per_area ? 1.0 : 1 / s2, exponent);
}

Image level_image(const Texels& texels, int size, double flux_unit, const RenderSpace& space) {
    Image image(size, size);
    for (const char* name :
         {"P.X", "P.Y", "P.Z", "N.X", "N.Y", "N.Z", "flux.R", "flux.G", "flux.B", "Z"})
        image.plane(name);
    const VectorPlanes p(image, "P.", "XYZ"), n(image, "N.", "XYZ"), flux(image, "flux.", "RGB");
    Array2D<float>& depth = image.plane("Z");
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const size_t i = size_t(y) * size_t(size) + size_t(x);
            if (!std::isfinite(texels.depth[i])) continue;
            p.set(x, y, space.to_world(V3d(texels.position(i))));
            n.set(x, y, V3d(texels.normal(i)));
            flux.set(x, y, V3d(texels.flux(i)) * flux_unit);
            depth(x, y) = float(double(texels.depth[i]) / space.scale);
        }
    return image;
}

} // namespace

std::vector<Image> map_images(std::span<const ReflectiveShadowMap> maps, const World& world,
                              int light_exponent, FluxMeasure measure, MipUse mips) {
    std::vector<Image> images;
    for (size_t m = 0; m < maps.size(); ++m) {
        const ReflectiveShadowMap& map = maps[m];
        const MipChain chain(map, mips == MipUse::on ? MipLevels::all : MipLevels::first);
        const double unit = flux_scale(map, world, light_exponent, measure);
        for (int level = 0; level < chain.levels(); ++level) {
            Image image = level_image(chain.texels(level), chain.size(level), unit, world.space);
            image.name = fmt::format("{}:{}", m, map.name);
            if (level > 0) image.name += fmt::format(".mip{}", level);
            images.push_back(std::move(image));
        }
    }
    return images;
}

} // namespace ql
