// Options of reflective shadow maps: maps, gathers, passes.
#pragma once

#include "cli/tool.h"
#include "rsm/render.h"

#include <string>

namespace ql::cli {

struct RsmClamp {
    enum class Kind { disc, distance, none };
    Kind kind = Kind::disc;
    double distance = 0; // metres
};

struct RsmOptions {
    RsmConfig config; // but for gather.bound and mask, which need scene and files
    RsmClamp clamp;
    std::string mask, map_output;
    int passes = 4;
    double time_limit_seconds = 0; // 0: none
    double max_memory_gib = 4;
};

void add_rsm_options(Tool& tool, RsmOptions& options);

// Fills in settings that follow from others, in `used` too, the options of --stats. Errors:
// ErrorKind::usage for some that would have no effect together.
void settle_rsm_options(const Tool& tool, RsmOptions& options, Json& used);

// The clamp in the lengths of render space.
GeometryBound geometry_bound(const RsmClamp& clamp, const RenderSpace& space);

// Thresholds of --rotate blue, from --mask or made on the spot; empty for other rotations.
Array2D<float> rotation_mask(Session& session, const RsmOptions& options);

} // namespace ql::cli
