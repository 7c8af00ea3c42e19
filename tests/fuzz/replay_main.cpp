// replay FILE|FOLDER...: runs the target over files, in the order of their names. Any compiler.
#include "fuzz.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include <unistd.h>

int main(int argc, char** argv) {
    std::vector<std::filesystem::path> files;
    for (int i = 1; i < argc; ++i) {
        const std::filesystem::path given = std::filesystem::absolute(argv[i]);
        if (!std::filesystem::is_directory(given)) {
            files.push_back(given);
            continue;
        }
        for (const auto& entry : std::filesystem::directory_iterator(given))
            files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    FILE* const messages = fdopen(dup(2), "w"); // targets may redirect the standard streams
    if (files.empty()) {
        std::fprintf(messages, "replay: no files, expected a corpus\n");
        return 2;
    }
    for (const std::filesystem::path& path : files) {
        std::ifstream stream(path, std::ios::binary);
        const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
        if (!stream.is_open()) {
            std::fprintf(messages, "replay: %s cannot be read\n", path.c_str());
            return 2;
        }
        // Said beforehand, so that the name is there if the target ends the process.
        std::fprintf(messages, "%s\n", path.c_str());
        std::fflush(messages);
        LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
    }
    std::fprintf(messages, "%zu inputs\n", files.size());
    return 0;
}
