#include "scene/gltf_load.h"

#include "base/error.h"
#include "image/atomic_file.h"
#include "scene/gltf_animation.h"
#include "scene/gltf_file.h"
#include "scene/gltf_import.h"
#include "scene/gltf_material.h"
#include "scene/gltf_node.h"
#include "scene/gltf_validate.h"

namespace ql {

namespace {

void import_file(const std::string& path, const GltfLoadConfig& config, const Workers& workers,
                 LoadedScene& loaded) {
    const auto model = read_gltf_file(path, config);
    const std::string name = input_name(path);
    GltfImport in = {name, *model, config, loaded.scene, loaded.warnings};
    warn_of_extensions(in);
    import_nodes(in);
    import_animations(in);
    decode_textures(in, workers);
}

} // namespace

LoadedScene load_gltf(const std::vector<std::string>& paths, const GltfLoadConfig& config,
                      const Workers& workers) {
    if (paths.empty()) throw usage_error("no scene file given");
    LoadedScene loaded;
    for (const std::string& path : paths)
        import_file(path, config, workers, loaded);
    if (loaded.scene.meshes.empty() && loaded.scene.shapes.empty())
        throw input_error("{}: no triangle and no shape to render", paths.front());
    return loaded;
}

} // namespace ql
