// State of importing one glTF file: the parsed model, the scene it goes into, what has been
// imported already, and how errors and warnings are worded. Internal to the gltf_*.cpp files.
#pragma once

#include "base/error.h"
#include "scene/gltf_load.h"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace tinygltf {
class Model;
}

namespace ql {

struct GltfImport {
    const std::string& file;
    const tinygltf::Model& model;
    const GltfLoadConfig& config;
    Scene& scene;
    std::vector<std::string>& warnings;

    // What was imported: index in the file (-1: default material) to index in the scene.
    std::map<int, int> materials = {};
    std::map<int, int> images = {}; // to textures
    std::map<int, std::vector<int>> meshes = {};
    std::vector<int> nodes = {}; // -1: not in the default scene
    size_t elements = 0;         // vertices and indices so far

    template<class... Args>
    Error error(fmt::format_string<Args...> format, Args&&... args) const {
        return input_error("{}: {}", file, fmt::format(format, std::forward<Args>(args)...));
    }

    template<class... Args>
    void warn(fmt::format_string<Args...> format, Args&&... args) {
        const std::string line =
            fmt::format("{}: {}", file, fmt::format(format, std::forward<Args>(args)...));
        if (std::find(warnings.begin(), warnings.end(), line) == warnings.end())
            warnings.push_back(line);
    }

    // list[index], or an error such as "node 3: mesh 7, but the file has 2".
    template<class T>
    const T& at(const std::vector<T>& list, int index, const std::string& where,
                const char* what) const {
        if (index < 0 || size_t(index) >= list.size())
            throw error("{}: {} {}, but the file has {}", where, what, index, list.size());
        return list[size_t(index)];
    }

    // Counts elements against the limit before memory is taken for them.
    void spend(size_t count, const std::string& where) {
        if (count > config.max_elements - elements)
            throw error("{}: {} elements, more than the limit of {} in a file", where, count,
                        config.max_elements);
        elements += count;
    }
};

} // namespace ql
