#include "scene/gltf_accessor.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

namespace ql {

namespace {

// Elements of an accessor without a buffer view are zeros that no buffer vouches for.
constexpr size_t kMaxZeroElements = size_t(1) << 24;

size_t saturated_product(size_t a, size_t b) {
    size_t product = 0;
    return __builtin_mul_overflow(a, b, &product) ? std::numeric_limits<size_t>::max() : product;
}

size_t saturated_sum(size_t a, size_t b) {
    size_t sum = 0;
    return __builtin_add_overflow(a, b, &sum) ? std::numeric_limits<size_t>::max() : sum;
}

size_t component_bytes(int type) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return 4;
    default:
        return 0;
    }
}

int component_count(int type) {
    switch (type) {
    case TINYGLTF_TYPE_SCALAR:
        return 1;
    case TINYGLTF_TYPE_VEC2:
        return 2;
    case TINYGLTF_TYPE_VEC3:
        return 3;
    case TINYGLTF_TYPE_VEC4:
        return 4;
    default:
        return 0; // matrices are for skins only
    }
}

template<class Stored>
Stored stored(const unsigned char* bytes) {
    Stored value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

template<class T, class Stored>
T from_integer(const unsigned char* bytes, bool normalized) {
    const T value = T(stored<Stored>(bytes));
    if constexpr (std::is_floating_point_v<T>)
        if (normalized) return std::max(value / T(std::numeric_limits<Stored>::max()), T(-1));
    return value;
}

template<class T>
T component(const unsigned char* bytes, int type, bool normalized) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return from_integer<T, int8_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return from_integer<T, uint8_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return from_integer<T, int16_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return from_integer<T, uint16_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return from_integer<T, uint32_t>(bytes, normalized);
    default:
        return T(stored<float>(bytes));
    }
}

// Where elements lie, once it is known that all of them lie inside their buffer.
struct Elements {
    const unsigned char* first = nullptr;
    size_t stride = 0;
};

Elements checked_elements(const GltfImport& in, const std::string& where, int view_index,
                          size_t offset, size_t count, size_t element_bytes) {
    const ByteRange range = buffer_view_bytes(in, view_index, where);
    const size_t given = in.model.bufferViews[size_t(view_index)].byteStride;
    const size_t stride = given == 0 ? element_bytes : given;
    if (stride < element_bytes)
        throw in.error("{}: byteStride {}, expected at least {}", where, stride, element_bytes);
    if (count == 0) return {range.first, stride};
    const size_t bytes = saturated_sum(saturated_product(count - 1, stride), element_bytes);
    if (saturated_sum(offset, bytes) > range.size)
        throw in.error("{}: {} bytes from offset {} in a buffer view of {} bytes", where, bytes,
                       offset, range.size);
    return {range.first + offset, stride};
}

template<class T>
void copy_elements(const Elements& from, size_t count, int type, bool normalized,
                   AccessorValues<T>& to) {
    const size_t bytes = component_bytes(type);
    const size_t components = size_t(to.components);
    for (size_t i = 0; i < count; ++i)
        for (size_t c = 0; c < components; ++c)
            to.values[i * components + c] =
                component<T>(from.first + i * from.stride + c * bytes, type, normalized);
}

// Sparse accessors replace single elements, named by ascending indices.
template<class T>
void replace_sparse(const GltfImport& in, const tinygltf::Accessor& accessor,
                    const std::string& where, AccessorValues<T>& values) {
    const auto& sparse = accessor.sparse;
    const int type = sparse.indices.componentType;
    if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
        type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
        throw in.error("{}: sparse indices of component type {}, expected unsigned", where, type);
    if (sparse.count < 0 || size_t(sparse.count) > values.count)
        throw in.error("{}: {} sparse values in {} elements", where, sparse.count, values.count);
    if (sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
        throw in.error("{}: negative byteOffset of sparse values", where);

    const size_t count = size_t(sparse.count);
    const size_t components = size_t(values.components);
    const Elements indices =
        checked_elements(in, where + " sparse indices", sparse.indices.bufferView,
                         size_t(sparse.indices.byteOffset), count, component_bytes(type));
    const Elements replacements = checked_elements(
        in, where + " sparse values", sparse.values.bufferView, size_t(sparse.values.byteOffset),
        count, component_bytes(accessor.componentType) * components);
    AccessorValues<T> replaced = {count, values.components, std::vector<T>(count * components)};
    copy_elements(replacements, count, accessor.componentType, accessor.normalized, replaced);

    uint64_t previous = 0;
    for (size_t i = 0; i < count; ++i) {
        const uint32_t index = component<uint32_t>(indices.first + i * indices.stride, type, false);
        if (index >= values.count)
            throw in.error("{}: sparse index {} in {} elements", where, index, values.count);
        if (i > 0 && index <= previous)
            throw in.error("{}: sparse index {} after {}, expected ascending ones", where, index,
                           previous);
        previous = index;
        std::copy_n(&replaced.values[i * components], components,
                    &values.values[size_t(index) * components]);
    }
}

template<class T>
AccessorValues<T> checked_values(GltfImport& in, const tinygltf::Accessor& accessor,
                                 const std::string& where) {
    const size_t bytes = component_bytes(accessor.componentType);
    const int components = component_count(accessor.type);
    if (bytes == 0)
        throw in.error("{}: component type {} is not one of glTF's", where, accessor.componentType);
    if (components == 0) throw in.error("{}: of a type that is not a scalar or vector", where);

    // Check that the elements exist before memory is taken for them.
    Elements elements;
    if (accessor.bufferView >= 0)
        elements = checked_elements(in, where, accessor.bufferView, accessor.byteOffset,
                                    accessor.count, bytes * size_t(components));
    else if (accessor.count > kMaxZeroElements)
        throw in.error("{}: {} elements without a buffer view, more than the limit of {}", where,
                       accessor.count, kMaxZeroElements);
    in.spend(accessor.count, where);

    AccessorValues<T> values = {accessor.count, components,
                                std::vector<T>(accessor.count * size_t(components))};
    if (accessor.bufferView >= 0)
        copy_elements(elements, accessor.count, accessor.componentType, accessor.normalized,
                      values);
    if (accessor.sparse.isSparse) replace_sparse(in, accessor, where, values);
    return values;
}

void check_rule(const GltfImport& in, const tinygltf::Accessor& accessor, const std::string& where,
                const AccessorRule& rule) {
    const int components = component_count(accessor.type);
    if (components < rule.min_components || components > rule.max_components)
        throw in.error(
            "{}: {} components, expected {}{} for {}", where, components, rule.min_components,
            rule.min_components == rule.max_components ? std::string()
                                                       : fmt::format(" to {}", rule.max_components),
            rule.what);
    if (accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT) return;
    if (rule.integers == IntegerRule::refused ||
        accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
        throw in.error("{}: integers of type {}, expected floats for {}", where,
                       accessor.componentType, rule.what);
    if (rule.integers == IntegerRule::normalized && !accessor.normalized)
        throw in.error("{}: integers that are not normalized, expected normalized ones for {}",
                       where, rule.what);
}

} // namespace

ByteRange buffer_view_bytes(const GltfImport& in, int view_index, const std::string& where) {
    const auto& view = in.at(in.model.bufferViews, view_index, where, "buffer view");
    const std::string name = fmt::format("buffer view {}", view_index);
    const auto& buffer = in.at(in.model.buffers, view.buffer, name, "buffer");
    if (saturated_sum(view.byteOffset, view.byteLength) > buffer.data.size())
        throw in.error("{}: {} bytes from offset {} in a buffer of {} bytes", name, view.byteLength,
                       view.byteOffset, buffer.data.size());
    return {buffer.data.data() + view.byteOffset, view.byteLength};
}

template<class T>
AccessorValues<T> read_accessor(GltfImport& in, int index, const AccessorRule& rule) {
    const auto& accessor = in.at(in.model.accessors, index, rule.what, "accessor");
    const std::string where = fmt::format("accessor {}", index);
    check_rule(in, accessor, where, rule);
    return checked_values<T>(in, accessor, where);
}

template AccessorValues<float> read_accessor(GltfImport&, int, const AccessorRule&);
template AccessorValues<double> read_accessor(GltfImport&, int, const AccessorRule&);

std::vector<uint32_t> read_index_accessor(GltfImport& in, int index, const std::string& what) {
    const auto& accessor = in.at(in.model.accessors, index, what, "accessor");
    const std::string where = fmt::format("accessor {}", index);
    const int type = accessor.componentType;
    if (component_count(accessor.type) != 1 || (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
                                                type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
                                                type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT))
        throw in.error("{}: component type {}, expected unsigned scalars for the indices of {}",
                       where, type, what);
    return checked_values<uint32_t>(in, accessor, where).values;
}

} // namespace ql
