#include "scene/gltf_value.h"

#include <tiny_gltf.h>

#include <algorithm>

namespace ql {

double clamped(GltfImport& in, double value, Range range, const std::string& what) {
    const double inside = std::clamp(value, range.low, range.high);
    if (inside != value) in.warn("{} is {}, outside [{}, {}]", what, value, range.low, range.high);
    return inside;
}

bool ExtensionObject::has(const char* key) const {
    return m_object.Has(key);
}

double ExtensionObject::number(const char* key, double fallback) const {
    if (!has(key)) return fallback;
    if (!m_object.Get(key).IsNumber()) throw m_in.error("{} {} is not a number", m_where, key);
    return m_object.Get(key).GetNumberAsDouble();
}

double ExtensionObject::number_in(const char* key, double fallback, Range range) const {
    return clamped(m_in, number(key, fallback), range, m_where + " " + key);
}

int ExtensionObject::index(const char* key) const {
    if (!has(key)) return -1;
    const tinygltf::Value& value = m_object.Get(key);
    if (!value.IsInt() || value.Get<int>() < 0)
        throw m_in.error("{} {} is not an index", m_where, key);
    return value.Get<int>();
}

std::string ExtensionObject::text(const char* key, const std::string& fallback) const {
    if (!has(key)) return fallback;
    if (!m_object.Get(key).IsString()) throw m_in.error("{} {} is not a string", m_where, key);
    return m_object.Get(key).Get<std::string>();
}

std::vector<double> ExtensionObject::numbers(const char* key, std::vector<double> fallback) const {
    if (!has(key)) return fallback;
    const tinygltf::Value& list = m_object.Get(key);
    const auto bad = [&] {
        return m_in.error("{} {} is not a list of {} numbers", m_where, key, fallback.size());
    };
    if (!list.IsArray() || list.ArrayLen() != fallback.size()) throw bad();
    for (size_t i = 0; i < fallback.size(); ++i) {
        if (!list.Get(int(i)).IsNumber()) throw bad();
        fallback[i] = list.Get(int(i)).GetNumberAsDouble();
    }
    return fallback;
}

Imath::V3f ExtensionObject::color(const char* key) const {
    const std::vector<double> values = numbers(key, {1, 1, 1});
    Imath::V3f result;
    for (int c = 0; c < 3; ++c)
        result[c] = float(clamped(m_in, values[size_t(c)], {0, 1}, m_where + " " + key));
    return result;
}

std::optional<ExtensionObject> ExtensionObject::object(const char* key) const {
    if (!has(key)) return std::nullopt;
    if (!m_object.Get(key).IsObject()) throw m_in.error("{} {} is not an object", m_where, key);
    return ExtensionObject(m_in, m_object.Get(key), m_where + " " + key);
}

std::vector<ExtensionObject> ExtensionObject::objects(const char* key) const {
    std::vector<ExtensionObject> result;
    if (!has(key)) return result;
    const tinygltf::Value& list = m_object.Get(key);
    if (!list.IsArray()) throw m_in.error("{} {} is not a list", m_where, key);
    for (size_t i = 0; i < list.ArrayLen(); ++i) {
        const std::string where = fmt::format("{} {} {}", m_where, key, i);
        if (!list.Get(int(i)).IsObject()) throw m_in.error("{} is not an object", where);
        result.emplace_back(m_in, list.Get(int(i)), where);
    }
    return result;
}

std::optional<ExtensionObject> extension(GltfImport& in,
                                         const std::map<std::string, tinygltf::Value>& extensions,
                                         const char* name, const std::string& owner) {
    const auto found = extensions.find(name);
    if (found == extensions.end()) return std::nullopt;
    const std::string where = owner.empty() ? name : owner + " " + name;
    if (!found->second.IsObject()) throw in.error("{} is not an object", where);
    return ExtensionObject(in, found->second, where);
}

} // namespace ql
