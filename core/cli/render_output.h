// Options of the image that a renderer writes: file, format, depth, exposure.
#pragma once

#include "cli/tool.h"

#include <string>
#include <vector>

namespace ql::cli {

struct RenderOutput {
    std::string path;
    FileFormat format = FileFormat::by_extension;
    bool half = false;
    float exposure_stops = 0;
};

// --output, --format, --half, --exposure
void add_render_output(Tool& tool, RenderOutput& output, const std::string& what);

ImageWriteConfig image_config(const Session& session, const RenderOutput& output);

// Errors: ErrorKind::usage if there are several frames for a name without %04d. Empty names are
// files that nobody asked for.
void check_frame_names(const std::vector<int>& frames, const std::vector<std::string>& paths);

} // namespace ql::cli
