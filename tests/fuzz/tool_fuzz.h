// Runs the tools' own main() inside this process, in a scratch folder with small inputs.
//
// The folder holds scene.gltf, image.exr, mask.png, mask.exr, retarget.exr, seeds.exr, cache.exr
// and options.toml; whatever a run changes there is put back.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ql::fuzz {

struct ToolUnderTest {
    const char* name;
    int (*main)(int, char**);
    std::vector<std::string> command; // a short run that succeeds
    // Options that a run is given unless it has them, so that it is short: name and value.
    std::vector<std::pair<std::string, std::string>> small;
};

const std::vector<ToolUnderTest>& tools();

// Exit status; more than 4 is reported as a finding. Arguments that name other folders are not run;
// those that could ask for a long run are parsed and no more.
void run_tool(const ToolUnderTest& tool, std::vector<std::string> arguments,
              std::string_view options_file = {});

} // namespace ql::fuzz
