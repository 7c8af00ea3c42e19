#include "cli/scene_options.h"

#include "geometry/embree_scene.h"
#include "image/frame_range.h"
#include "scene/features.h"
#include "scene/gltf_load.h"
#include "scene/scene_hash.h"

namespace ql::cli {

namespace {

V3d parse_vector(const std::string& text, const std::string& option) {
    const std::vector<double> v = parse_numbers(text, 3, option);
    return {v[0], v[1], v[2]};
}

} // namespace

void add_scene_options(Tool& tool, SceneOptions& options) {
    tool.add_library(embree_version());
    tool.app
        .add_option("scene", options.paths, "glTF files (.gltf, .glb), put together into one scene")
        ->type_name("SCENE")
        ->required();
    auto* camera = tool.app.add_option("--camera", options.camera.name,
                                       "Camera of the scene, by name or index");
    camera->type_name("NAME|INDEX");
    auto* from = tool.app.add_option_function<std::string>(
        "--look-from",
        [&options](const std::string& text) {
            options.camera.look_from = parse_vector(text, "--look-from");
            options.camera.explicit_view = true;
        },
        "Camera position in metres");
    auto* at = tool.app.add_option_function<std::string>(
        "--look-at",
        [&options](const std::string& text) {
            options.camera.look_at = parse_vector(text, "--look-at");
        },
        "Point in the middle of the image");
    from->type_name("X,Y,Z")->needs(at)->excludes(camera);
    at->type_name("X,Y,Z")->needs(from);
    tool.app.add_option("--fov", options.camera.fov_degrees, "Vertical angle of view in degrees")
        ->type_name("DEG")
        ->check([](const std::string& text) {
            const double value = std::atof(text.c_str());
            return value > 0 && value < 180 ? std::string()
                                            : "expected an angle between 0 and 180 degrees";
        })
        ->default_str("");
    tool.add_size(options.size, "Image size in pixels");
    tool.app.add_flag("--allow-dark", options.allow_dark, "Render a scene without any light");
}

void add_frame_options(Tool& tool, SceneOptions& options) {
    tool.app
        .add_option_function<std::string>(
            "--frames",
            [&options](const std::string& text) { options.frames = parse_frame_range(text); },
            "Frames to render, A-B or A-BxS; the output is numbered with %04d")
        ->type_name("RANGE")
        ->default_str("0");
    tool.app.add_option("--fps", options.fps, "Frames per second of animated nodes")
        ->check([](const std::string& text) {
            return std::atof(text.c_str()) > 0 ? std::string() : "expected a positive number";
        });
}

OpenScene open_scene(Session& session, const SceneOptions& options, LightNeed need) {
    const PhaseTimer timer = session.phase("load");
    for (const std::string& path : options.paths)
        session.stats().input.push_back(path);
    LoadedScene loaded = load_gltf(options.paths, {}, session.workers());
    for (const std::string& warning : loaded.warnings)
        session.warn(warning);
    OpenScene open{std::move(loaded.scene), {}, {}};
    open.space = render_space_of(open.scene, session.workers());
    open.camera = choose_camera(open.scene, open.space, options.camera);
    if (open.camera.is_framed)
        session.warn(fmt::format("{}: no camera; the whole scene is framed (see --look-from)",
                                 options.paths.front()));
    // Say what the scene requires.
    const SceneFeatures features = required_features(open.scene);
    session.inform(fmt::format("{}: {}", options.paths.front(), feature_line(features)));
    Json& stats = session.stats().scene;
    for (const auto& [name, count] : feature_counts(features))
        stats[name] = count;
    stats["non_finite_vertices"] = open.scene.non_finite_vertices;
    stats["degenerate_triangles"] = open.scene.degenerate_triangles;
    stats["hash"] = fmt::format("{:016x}", scene_hash(open.scene));
    if (need == LightNeed::required && !options.allow_dark && !features.has_light())
        throw input_error("{}: no light and no emitter (--allow-dark renders it all the same)",
                          options.paths.front());
    return open;
}

} // namespace ql::cli
