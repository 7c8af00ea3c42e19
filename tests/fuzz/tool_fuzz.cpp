#include "tool_fuzz.h"

#include "fuzz.h"

#include "image/atomic_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>

// The tools' main functions under names of their own, see CMakeLists.txt.
#define QL_TOOL(name) extern "C" int ql_main_##name(int, char**);
QL_TOOL(bn_anneal)
QL_TOOL(bn_mask)
QL_TOOL(bn_permute)
QL_TOOL(bn_render)
QL_TOOL(img_diff)
QL_TOOL(img_spectrum)
QL_TOOL(ls_inject)
QL_TOOL(ls_merge)
QL_TOOL(ls_sample)
QL_TOOL(rsm_render)
#undef QL_TOOL

namespace ql::fuzz {

namespace {

// A floor of two triangles, a point light above, a camera.
constexpr std::string_view kScene = R"({"asset": {"version": "2.0"},
"extensionsUsed": ["KHR_lights_punctual"],
"extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 5}]}},
"scene": 0, "scenes": [{"nodes": [0, 1, 2]}],
"nodes": [{"mesh": 0},
 {"translation": [0.5, 0.5, 1], "extensions": {"KHR_lights_punctual": {"light": 0}}},
 {"camera": 0, "translation": [0.5, 0.5, 2]}],
"cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
  "min": [0, 0, 0], "max": [1, 1, 0]},
 {"bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR"}],
"bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 6}],
"buffers": [{"byteLength": 54, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAAAAECAAID"}]})";

// The numbers that a run may be given: none can make it long.
constexpr int kMaxNumber = 16;

std::vector<ToolUnderTest> make_tools() {
    const std::pair<std::string, std::string> size = {"--size", "4x4"};
    return {
        {"bn-mask", ql_main_bn_mask, {"-o", "out.exr"}, {{"--size", "8x8"}}},
        {"bn-render", ql_main_bn_render, {"scene.gltf", "-o", "out.exr"}, {size}},
        {"bn-anneal", ql_main_bn_anneal, {"mask.exr", "-o", "out.exr"}, {{"--radius", "2"}}},
        {"bn-permute",
         ql_main_bn_permute,
         {"--image", "image.exr", "--mask", "mask.exr", "-o", "out.exr"},
         {}},
        {"rsm-render",
         ql_main_rsm_render,
         {"scene.gltf", "-o", "out.exr"},
         {size, {"--rsm-size", "4"}, {"--samples", "4"}}},
        {"ls-inject",
         ql_main_ls_inject,
         {"scene.gltf", "-o", "out.exr"},
         {{"--voxels", "2x2x2"}, {"--patches", "2"}, {"--photons", "99"}}},
        {"ls-merge", ql_main_ls_merge, {"cache.exr", "-o", "out.exr"}, {}},
        {"ls-sample",
         ql_main_ls_sample,
         {"scene.gltf", "--cache", "cache.exr", "-o", "out.exr"},
         {size}},
        {"img-diff", ql_main_img_diff, {"image.exr", "image.exr"}, {}},
        {"img-spectrum", ql_main_img_spectrum, {"--mask", "mask.png"}, {}},
    };
}

int run_main(const ToolUnderTest& tool, const std::vector<std::string>& arguments) {
    // The tools close standard output; give them streams that may be closed and that say nothing.
    static FILE* const nowhere = std::fopen("/dev/null", "w");
    stderr = nowhere;
    stdout = std::fopen("/dev/null", "w");
    std::vector<std::string> words = {tool.name};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words)
        pointers.push_back(word.data());
    pointers.push_back(nullptr);
    return tool.main(int(words.size()), pointers.data());
}

// The files of the scratch folder as they should be.
class Fixtures {
  public:
    Fixtures() {
        std::filesystem::current_path(scratch_folder());
        write_file("scene.gltf", std::string(kScene));
        write_file("options.toml", std::string("threads = 1\n"));
        made("bn-mask", {"--size", "8x8", "-o", "mask.exr"});
        made("bn-mask", {"--size", "8x8", "-o", "mask.png"});
        made("bn-anneal", {"mask.exr", "--radius", "2", "-o", "retarget.exr"});
        made("bn-render", {"scene.gltf", "--size", "4x4", "--aov", "all", "--spp", "2", "-o",
                           "image.exr", "--seeds-out", "seeds.exr"});
        made("ls-inject", {"scene.gltf", "--photons", "99", "--voxels", "2x2x2", "--patches", "2",
                           "-o", "cache.exr"});
        for (const auto& entry : std::filesystem::directory_iterator("."))
            m_files[entry.path().filename()] = {read_file(entry.path()), state_of(entry.path())};
    }

    void restore() {
        for (const auto& entry : std::filesystem::directory_iterator(".")) {
            const auto known = m_files.find(entry.path().filename());
            if (known == m_files.end() || state_of(entry.path()) != known->second.state)
                std::filesystem::remove_all(entry.path());
        }
        for (auto& [name, file] : m_files)
            if (!std::filesystem::exists(name)) {
                write_file(name, file.bytes);
                file.state = state_of(name);
            }
    }

  private:
    using State = std::pair<uint64_t, int64_t>;
    struct File {
        std::vector<std::byte> bytes;
        State state;
    };

    static State state_of(const std::filesystem::path& path) {
        struct stat s = {};
        stat(path.c_str(), &s);
        return {s.st_ino, int64_t(s.st_mtim.tv_sec) * 1'000'000'000 + s.st_mtim.tv_nsec};
    }

    static void made(const std::string& name, const std::vector<std::string>& arguments) {
        for (const ToolUnderTest& tool : tools())
            if (tool.name == name && run_main(tool, arguments) != 0)
                report_finding(name + " cannot make what the targets need");
    }

    std::map<std::string, File> m_files;
};

// Whether a text names the option `name` ("--size") and not only a longer one ("rsm-size").
bool names_option(std::string_view text, std::string_view name) {
    name.remove_prefix(2);
    for (size_t at = text.find(name); at != text.npos; at = text.find(name, at + 1))
        if (at == 0 || std::string_view("-_").find(text[at - 1]) == std::string_view::npos)
            return true;
    return false;
}

bool has_option(const std::vector<std::string>& arguments, std::string_view options_file,
                const std::string& name) {
    return names_option(options_file, name) ||
           std::any_of(arguments.begin(), arguments.end(),
                       [&](const std::string& word) { return word.starts_with(name); });
}

// Whether every number is small and plainly written.
bool is_short_run(std::string_view text) {
    if (text.find("time-limit") != text.npos || text.find("snapshot") != text.npos) return false;
    for (size_t i = 0; i < text.size();) {
        if (text[i] < '0' || text[i] > '9') {
            ++i;
            continue;
        }
        int number = 0;
        for (; i < text.size() && text[i] >= '0' && text[i] <= '9'; ++i)
            number = std::min(number * 10 + (text[i] - '0'), 1 << 20);
        if (number > kMaxNumber) return false;
        if (i < text.size() && std::string_view("eEpPxX").find(text[i]) != std::string_view::npos &&
            (i + 1 == text.size() || text[i + 1] < '1' || text[i + 1] > '9' || text[i] != 'x'))
            return false;
    }
    return true;
}

} // namespace

const std::vector<ToolUnderTest>& tools() {
    static const std::vector<ToolUnderTest> all = make_tools();
    return all;
}

void run_tool(const ToolUnderTest& tool, std::vector<std::string> arguments,
              std::string_view options_file) {
    static Fixtures fixtures;
    std::string text(options_file);
    for (const std::string& word : arguments)
        text += '\n' + word;
    if (text.find('/') != text.npos || text.find('\0') != text.npos) return;
    if (!options_file.empty()) write_file("options.toml", std::string(options_file));
    for (const auto& [name, value] : tool.small)
        if (!has_option(arguments, options_file, name)) {
            arguments.push_back(name);
            arguments.push_back(value);
        }
    // An option that is not there stops the tool after it has taken in all others.
    if (!is_short_run(text)) arguments.push_back("--no-such-option");
    const int status = run_main(tool, arguments);
    if (status < 0 || status > int(ErrorKind::output))
        report_finding(fmt::format("{} ends with status {}", tool.name, status));
    fixtures.restore();
}

} // namespace ql::fuzz
