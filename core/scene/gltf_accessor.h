// Values behind glTF accessors, checked against their buffer views and buffers before anything is
// read or allocated: strides, component types, normalised integers, sparse replacements.
#pragma once

#include "scene/gltf_import.h"

#include <cstdint>
#include <string>
#include <vector>

namespace ql {

enum class IntegerRule { refused, normalized, any };

// What a use of an accessor allows.
struct AccessorRule {
    std::string what; // for messages, such as "mesh 3 NORMAL"
    int min_components = 1;
    int max_components = 1;
    IntegerRule integers = IntegerRule::any;
};

template<class T>
struct AccessorValues {
    size_t count = 0;
    int components = 1;
    std::vector<T> values; // count * components
};

// Normalised integers become [0, 1] or [-1, 1] (glTF 2.0, section 3.6.2.2); other integers keep
// their value. T: float or double.
template<class T>
AccessorValues<T> read_accessor(GltfImport& in, int accessor, const AccessorRule& rule);

// 8, 16 or 32 bit unsigned scalars.
std::vector<uint32_t> read_index_accessor(GltfImport& in, int accessor, const std::string& what);

// The bytes of a whole buffer view, for images.
struct ByteRange {
    const unsigned char* first = nullptr;
    size_t size = 0;
};
ByteRange buffer_view_bytes(const GltfImport& in, int view, const std::string& where);

} // namespace ql
