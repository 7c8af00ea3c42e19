#include "cli/path_options.h"

namespace ql::cli {

void add_path_options(Tool& tool, int& roulette_depth, bool& all_lights) {
    tool.app
        .add_option("--roulette-depth", roulette_depth,
                    "Scatterings before Russian roulette sets in")
        ->check(CLI::Range(1, 1 << 16));
    // After the depth, whose callback comes first.
    tool.app.add_flag_callback(
        "--no-roulette", [&roulette_depth] { roulette_depth = 0; }, "No Russian roulette");
    tool.app.add_flag("--all-lights", all_lights,
                      "At the first surface sample each point, spot and directional light, and one "
                      "emitter, instead of one light of all (up to 32 lights)");
}

} // namespace ql::cli
