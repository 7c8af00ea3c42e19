// Reading the members of a glTF extension object, with range checks and errors that say where.
#pragma once

#include "scene/gltf_import.h"

#include <Imath/ImathVec.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tinygltf {
class Value;
}

namespace ql {

// Range of a factor. What lies outside is moved to the nearest end, with a warning.
struct Range {
    double low = 0;
    double high = 1;
};

double clamped(GltfImport& in, double value, Range range, const std::string& what);

class ExtensionObject {
  public:
    // where: such as "material 3 KHR_materials_ior", for messages.
    ExtensionObject(GltfImport& in, const tinygltf::Value& object, std::string where)
        : m_in(in), m_object(object), m_where(std::move(where)) {}

    bool has(const char* key) const;
    double number(const char* key, double fallback) const;
    double number_in(const char* key, double fallback, Range range) const;
    // -1 if missing.
    int index(const char* key) const;
    std::string text(const char* key, const std::string& fallback) const;
    // `size` numbers, or the fallback if missing.
    std::vector<double> numbers(const char* key, std::vector<double> fallback) const;
    Imath::V3f color(const char* key) const; // within [0, 1]; white if missing
    std::optional<ExtensionObject> object(const char* key) const;
    std::vector<ExtensionObject> objects(const char* key) const;

    const std::string& where() const { return m_where; }
    const tinygltf::Value& value() const { return m_object; }

  private:
    GltfImport& m_in;
    const tinygltf::Value& m_object;
    std::string m_where;
};

// The object of an extension, if it is there. An extension that is not an object is an error.
std::optional<ExtensionObject> extension(GltfImport& in,
                                         const std::map<std::string, tinygltf::Value>& extensions,
                                         const char* name, const std::string& owner);

} // namespace ql
