#include "cli/render_output.h"

#include "image/frame_range.h"

namespace ql::cli {

void add_render_output(Tool& tool, RenderOutput& output, const std::string& what) {
    tool.add_output(output.path, what);
    tool.add_format(output.format);
    tool.app.add_flag("--half", output.half, "Write 16-bit floats");
    tool.app
        .add_option("--exposure", output.exposure_stops,
                    "Stops by which PNG pictures are brightened")
        ->check(CLI::Range(-100.0, 100.0));
}

ImageWriteConfig image_config(const Session& session, const RenderOutput& output) {
    ImageWriteConfig config = session.image_config();
    config.format = output.format;
    config.depth = output.half ? FloatDepth::half : FloatDepth::float32;
    config.exposure_stops = output.exposure_stops;
    return config;
}

void check_frame_names(const std::vector<int>& frames, const std::vector<std::string>& paths) {
    for (const std::string& path : paths)
        if (frames.size() > 1 && !path.empty() && !is_numbered(path))
            throw usage_error("{}: {} frames need a numbered name such as frame.%04d.exr", path,
                              frames.size());
}

} // namespace ql::cli
