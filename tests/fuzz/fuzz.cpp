#include "fuzz.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace ql::fuzz {

namespace {

// Standard error as it is at the start: libFuzzer and the targets send it elsewhere.
const int g_messages = dup(2);

} // namespace

const std::string& scratch_folder() {
    struct Folder {
        std::string path = std::filesystem::temp_directory_path() / "fuzz-XXXXXX";
        Folder() {
            if (!mkdtemp(path.data())) report_finding("no scratch folder");
        }
        ~Folder() {
            std::error_code ignored;
            std::filesystem::remove_all(path, ignored);
        }
    };
    static const Folder folder;
    return folder.path;
}

const std::string& scratch_file(std::span<const uint8_t> bytes) {
    static const std::string path = scratch_folder() + "/input";
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    file.close();
    if (!file) report_finding("the scratch file cannot be written");
    return path;
}

void report_finding(const std::string& what) {
    const std::string line = "finding: " + what + "\n";
    (void)!write(g_messages, line.data(), line.size());
    std::abort();
}

void check_picture(const Image& image, const char* renderer) {
    for (const Plane<float>& plane : image.planes) {
        const bool is_radiance = plane.name.size() == 1 ? plane.name != "Z"
                                                        : plane.name.starts_with("direct.") ||
                                                              plane.name.starts_with("indirect.");
        for (size_t i = 0; i < plane.pixels.size(); ++i) {
            const float value = plane.pixels[i];
            if (!std::isfinite(value) || (is_radiance && value < 0))
                report_finding(fmt::format("{}: {} is {}", renderer, plane.name, value));
        }
    }
}

} // namespace ql::fuzz
