// Builds small glTF documents for the tests, as JSON that a test may change before it is loaded.
#pragma once

#include "base/error.h"
#include "image/atomic_file.h"
#include "scene/gltf_load.h"

#include <nlohmann/json.hpp>

#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

namespace ql::testing_gltf {

using nlohmann::json;

inline std::string base64(const std::vector<uint8_t>& bytes) {
    static const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t word = 0;
        for (size_t k = 0; k < 3; ++k)
            word = word << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
        for (size_t k = 0; k < 4; ++k)
            text += i + k > bytes.size() ? '=' : kDigits[word >> (18 - 6 * k) & 63];
    }
    return text;
}

// The glTF component type of a C++ type.
template<class T>
int component_type() {
    if (std::is_same_v<T, int8_t>) return 5120;
    if (std::is_same_v<T, uint8_t>) return 5121;
    if (std::is_same_v<T, int16_t>) return 5122;
    if (std::is_same_v<T, uint16_t>) return 5123;
    if (std::is_same_v<T, uint32_t>) return 5125;
    return 5126;
}

// A document with one mesh of one triangle (0,0,0) (1,0,0) (0,1,0): accessor 0 has the positions,
// accessor 1 the 16-bit indices.
class GltfBuilder {
  public:
    GltfBuilder() {
        doc = json::parse(R"({"asset": {"version": "2.0"}, "scene": 0,
            "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "materials": [{}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1,
                                        "material": 0}]}]})");
        accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
        accessor<uint16_t>("SCALAR", {0, 1, 2});
    }

    template<class T>
    int view(const std::vector<T>& values) {
        data.resize((data.size() + 3) / 4 * 4);
        const size_t offset = data.size();
        data.resize(offset + values.size() * sizeof(T));
        std::memcpy(&data[offset], values.data(), values.size() * sizeof(T));
        doc["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", values.size() * sizeof(T)}});
        return int(doc["bufferViews"].size()) - 1;
    }

    template<class T>
    int accessor(const std::string& type, const std::vector<T>& values, bool normalized = false) {
        const size_t components = type == "SCALAR" ? 1 : size_t(type[3] - '0');
        doc["accessors"].push_back({{"bufferView", view(values)},
                                    {"componentType", component_type<T>()},
                                    {"count", values.size() / components},
                                    {"type", type}});
        if (normalized) doc["accessors"].back()["normalized"] = true;
        return int(doc["accessors"].size()) - 1;
    }

    json& primitive() { return doc["meshes"][0]["primitives"][0]; }
    json& material() { return doc["materials"][0]; }
    json& node() { return doc["nodes"][0]; }

    std::string text() const {
        json whole = doc;
        if (!whole.contains("buffers"))
            whole["buffers"] = {{{"byteLength", data.size()},
                                 {"uri", "data:application/octet-stream;base64," + base64(data)}}};
        return whole.dump();
    }

    std::string glb() const {
        json whole = doc;
        whole["buffers"] = {{{"byteLength", data.size()}}};
        std::string text = whole.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        std::string binary(data.begin(), data.end());
        binary.resize((binary.size() + 3) / 4 * 4, '\0');
        const auto word = [](size_t value) {
            std::string bytes(4, '\0');
            const uint32_t w = uint32_t(value);
            std::memcpy(bytes.data(), &w, 4);
            return bytes;
        };
        return "glTF" + word(2) + word(28 + text.size() + binary.size()) + word(text.size()) +
               "JSON" + text + word(binary.size()) + std::string("BIN\0", 4) + binary;
    }

    json doc;
    std::vector<uint8_t> data;
};

// A folder of its own, removed with everything in it.
class ScratchFolder {
  public:
    ScratchFolder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "qlXXXXXX").string();
        m_path = mkdtemp(pattern.data());
    }
    ~ScratchFolder() { std::filesystem::remove_all(m_path); }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    std::string write(const std::string& name, const std::string& content) const {
        write_file(m_path + "/" + name, content);
        return m_path + "/" + name;
    }
    const std::string& path() const { return m_path; }

  private:
    std::string m_path;
};

inline LoadedScene load_text(const std::string& content, const std::string& name = "test.gltf") {
    const ScratchFolder folder;
    return load_gltf({folder.write(name, content)}, {}, Workers(2));
}

inline LoadedScene load(const GltfBuilder& builder) {
    return load_text(builder.text());
}

// The message without the name of the file, or "" if all went well. Errors of another kind than
// input, or of several lines, are told apart.
inline std::string error_of_text(const std::string& content,
                                 const std::string& name = "test.gltf") {
    const ScratchFolder folder;
    const std::string path = folder.write(name, content);
    try {
        load_gltf({path}, {}, Workers(1));
    } catch (const Error& error) {
        const std::string message = error.what();
        if (error.kind() != ErrorKind::input) return "not an input error: " + message;
        if (message.find('\n') != std::string::npos) return "several lines: " + message;
        if (!message.starts_with(path + ": ")) return "does not name the file: " + message;
        return message.substr(path.size() + 2);
    }
    return "";
}

inline std::string error_of(const GltfBuilder& builder) {
    return error_of_text(builder.text());
}

// Does any warning contain the text?
inline bool warned(const LoadedScene& loaded, const std::string& text) {
    for (const std::string& warning : loaded.warnings)
        if (warning.find(text) != std::string::npos) return true;
    return false;
}

} // namespace ql::testing_gltf
