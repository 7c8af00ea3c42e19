// Files for --config of all tools: the first byte is the tool, the rest the file.
#include "fuzz.h"
#include "tool_fuzz.h"

using namespace ql;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    if (size < 2) return 0;
    const fuzz::ToolUnderTest& tool = fuzz::tools()[data[0] % fuzz::tools().size()];
    std::vector<std::string> arguments = tool.command;
    arguments.insert(arguments.end(), {"--config", "options.toml"});
    fuzz::run_tool(tool, arguments, {reinterpret_cast<const char*>(data) + 1, size - 1});
    return 0;
}
