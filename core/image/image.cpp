#include "image/image.h"

#include <algorithm>

namespace ql {

namespace {

template<class Planes>
auto* find_plane(Planes& planes, std::string_view name) {
    const auto it = std::find_if(planes.begin(), planes.end(),
                                 [&](const auto& plane) { return plane.name == name; });
    return it == planes.end() ? nullptr : &it->pixels;
}

} // namespace

Array2D<float>& Image::plane(std::string_view plane_name) {
    if (auto* found = find_plane(planes, plane_name)) return *found;
    planes.push_back({std::string(plane_name), Array2D<float>(width, height)});
    return planes.back().pixels;
}

Array2D<uint32_t>& Image::uint_plane(std::string_view plane_name) {
    if (auto* found = find_plane(uint_planes, plane_name)) return *found;
    uint_planes.push_back({std::string(plane_name), Array2D<uint32_t>(width, height)});
    return uint_planes.back().pixels;
}

const Array2D<float>* Image::find(std::string_view plane_name) const {
    return find_plane(planes, plane_name);
}

const Array2D<uint32_t>* Image::find_uint(std::string_view plane_name) const {
    return find_plane(uint_planes, plane_name);
}

std::string Image::channel_names() const {
    std::string names;
    const auto append = [&](const std::string& plane_name) {
        if (!names.empty()) names += ", ";
        names += plane_name;
    };
    for (const auto& plane : planes)
        append(plane.name);
    for (const auto& plane : uint_planes)
        append(plane.name);
    return names;
}

} // namespace ql
