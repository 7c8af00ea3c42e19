// Options that every renderer shares: scene files, camera, image size, frames.
#pragma once

#include "cli/tool.h"
#include "render/posed_scene.h"

#include <string>
#include <vector>

namespace ql::cli {

struct SceneOptions {
    std::vector<std::string> paths;
    CameraChoice camera;
    Size size{512, 512};
    std::vector<int> frames{0};
    double fps = 24;
    bool allow_dark = false;
};

void add_scene_options(Tool& tool, SceneOptions& options);
// --frames and --fps, for tools that render sequences.
void add_frame_options(Tool& tool, SceneOptions& options);

// A scene with the render space and the camera that all its frames share.
struct OpenScene {
    Scene scene;
    RenderSpace space;
    ChosenCamera camera;
};

enum class LightNeed { required, provided_elsewhere };

// Loads, warns, fills stats.scene; timed as "load". Errors: no light although one is required and
// --allow-dark is not given.
OpenScene open_scene(Session& session, const SceneOptions& options, LightNeed need);

} // namespace ql::cli
