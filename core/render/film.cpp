#include "render/film.h"

#include "base/error.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace ql {

namespace {

constexpr std::pair<const char*, uint32_t> kNames[] = {
    {"depth", kAovDepth},       {"normal", kAovNormal},     {"position", kAovPosition},
    {"albedo", kAovAlbedo},     {"motion", kAovMotion},     {"direct", kAovDirect},
    {"indirect", kAovIndirect}, {"variance", kAovVariance}, {"id", kAovId}};

uint32_t aov_of(const std::string& name, uint32_t offered) {
    if (name == "all") return offered;
    std::string expected;
    for (const auto& [known, aov] : kNames) {
        if (!(aov & offered)) continue;
        if (name == known) return aov;
        expected += std::string(known) + ", ";
    }
    throw usage_error("--aov {}: expected {}all", name, expected);
}

} // namespace

uint32_t parse_aovs(const std::string& names, uint32_t offered) {
    uint32_t aovs = 0;
    for (size_t at = 0; at < names.size();) {
        const size_t comma = std::min(names.find(',', at), names.size());
        aovs |= aov_of(names.substr(at, comma - at), offered);
        at = comma + 1;
    }
    return aovs;
}

float saturated(double value) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return float(std::clamp(value, -kMost, kMost));
}

VectorPlanes::VectorPlanes(Image& image, const std::string& prefix, const std::string& suffixes) {
    for (size_t i = 0; i < 3; ++i)
        m_planes[i] = &image.plane(prefix + suffixes[i]);
}

void VectorPlanes::set(int x, int y, const Imath::V3d& value) const {
    for (int i = 0; i < 3; ++i)
        (*m_planes[i])(x, y) = saturated(value[i]);
}

Film::Film(int width, int height, uint32_t aovs) : image(width, height) {
    struct Group {
        uint32_t aov;
        VectorPlanes Film::*planes;
        const char* prefix;
        const char* suffixes;
    };
    const Group groups[] = {{0, &Film::beauty, "", "RGB"},
                            {kAovNormal, &Film::normal, "N.", "XYZ"},
                            {kAovPosition, &Film::position, "P.", "XYZ"},
                            {kAovAlbedo, &Film::albedo, "albedo.", "RGB"},
                            {kAovDirect, &Film::direct, "direct.", "RGB"},
                            {kAovIndirect, &Film::indirect, "indirect.", "RGB"},
                            {kAovVariance, &Film::variance, "variance.", "RGB"}};
    for (const Group& group : groups)
        if (group.aov == 0 || (aovs & group.aov))
            this->*group.planes = VectorPlanes(image, group.prefix, group.suffixes);
    if (aovs & kAovDepth) depth = &image.plane("Z");
    if (aovs & kAovMotion) {
        motion_x = &image.plane("motion.X");
        motion_y = &image.plane("motion.Y");
    }
    if (aovs & kAovId) id = &image.uint_plane("id");
}

} // namespace ql
