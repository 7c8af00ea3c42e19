// Images as sets of named planes, and the header values that travel with them.
//
// Float planes hold linear radiometric values or data; unsigned planes hold 32-bit words (seeds,
// shaft numbers) that must survive bit for bit. Planes are named as in the files: "R", "N.X",
// "direct.G", "seed". Pixel (0, 0) is the upper left one.
#pragma once

#include "base/array2d.h"

#include <Imath/ImathMatrix.h>

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace ql {

template<class T>
struct Plane {
    std::string name;
    Array2D<T> pixels;
};

using MetadataValue = std::variant<int, float, std::string, Imath::M44f, std::vector<float>>;
using Metadata = std::map<std::string, MetadataValue>;

struct Image {
    int width = 0;
    int height = 0;
    std::string name;                // of the part in a multi-part file; empty elsewhere
    int source_bits = 32;            // per channel in the file it was read from: 8, 16 or 32
    std::deque<Plane<float>> planes; // a deque: adding one leaves references to the others valid
    std::deque<Plane<uint32_t>> uint_planes;
    Metadata metadata;

    Image() = default;
    Image(int w, int h) : width(w), height(h) {}

    // Adds a plane of zeros, or returns the one that is there.
    Array2D<float>& plane(std::string_view plane_name);
    Array2D<uint32_t>& uint_plane(std::string_view plane_name);
    // The named plane or nullptr.
    const Array2D<float>* find(std::string_view plane_name) const;
    const Array2D<uint32_t>* find_uint(std::string_view plane_name) const;
    size_t channel_count() const { return planes.size() + uint_planes.size(); }
    // "R, G, B" for messages.
    std::string channel_names() const;
    // A metadata value of type T or nullptr.
    template<class T>
    const T* find_metadata(const std::string& key) const {
        const auto it = metadata.find(key);
        return it == metadata.end() ? nullptr : std::get_if<T>(&it->second);
    }
};

// Rec. 709 luminance of linear R, G, B.
constexpr float luminance(float r, float g, float b) {
    return 0.2126f * r + 0.7152f * g + 0.0722f * b;
}

} // namespace ql
