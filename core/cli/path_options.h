// Options of everything that follows paths from the camera.
#pragma once

#include "cli/tool.h"

namespace ql::cli {

// --roulette-depth, --no-roulette (which makes the depth 0) and --all-lights.
void add_path_options(Tool& tool, int& roulette_depth, bool& all_lights);

} // namespace ql::cli
