// Command lines of all tools: the first byte is the tool, the rest its arguments, one a line.
#include "fuzz.h"
#include "tool_fuzz.h"

using namespace ql;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    if (size == 0) return 0;
    const fuzz::ToolUnderTest& tool = fuzz::tools()[data[0] % fuzz::tools().size()];
    std::vector<std::string> arguments = {""};
    for (size_t i = 1; i < size; ++i)
        if (data[i] == '\n')
            arguments.emplace_back();
        else
            arguments.back() += char(data[i]);
    fuzz::run_tool(tool, arguments);
    return 0;
}
