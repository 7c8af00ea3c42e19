#include "scene/gltf_file.h"

#include "base/error.h"
#include "image/atomic_file.h"
#include "scene/gltf_validate.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <span>
#include <string_view>

namespace ql {

namespace {

// Deeper nesting than any glTF needs would exhaust the stack of recursive parsers.
constexpr int kMaxNesting = 128;
constexpr size_t kMaxMessage = 200;

// Directory that relative names start from, and the limit for each file: for the callbacks.
struct FileAccess {
    std::string folder;
    size_t max_bytes;
};

std::string folder_of(const std::string& path) {
    const size_t slash = path.rfind('/');
    if (slash == std::string::npos) return ".";
    return slash == 0 ? "/" : path.substr(0, slash);
}

// --- Checks of the bytes before tinygltf sees them ---------------------------------------------

uint32_t word_at(std::span<const std::byte> bytes, size_t offset) {
    uint32_t word = 0;
    std::memcpy(&word, &bytes[offset], sizeof word); // GLB and this machine are little-endian
    return word;
}

// The JSON chunk of a GLB whose header and chunk lengths hold.
std::string_view glb_json(std::span<const std::byte> bytes, const std::string& file) {
    constexpr uint32_t kJson = 0x4e4f534a;
    constexpr uint32_t kBinary = 0x004e4942;
    if (bytes.size() < 12) throw input_error("{}: GLB of {} bytes, truncated", file, bytes.size());
    if (word_at(bytes, 4) != 2)
        throw input_error("{}: GLB version {}, expected 2", file, word_at(bytes, 4));
    const size_t length = word_at(bytes, 8);
    if (length > bytes.size())
        throw input_error("{}: GLB of {} bytes, truncated to {}", file, length, bytes.size());
    if (length < 20) throw input_error("{}: GLB of {} bytes has no JSON chunk", file, length);
    const size_t json_bytes = word_at(bytes, 12);
    if (word_at(bytes, 16) != kJson || json_bytes > length - 20)
        throw input_error("{}: first GLB chunk has {} bytes of type {:#x}, expected JSON in {}",
                          file, json_bytes, word_at(bytes, 16), length - 20);
    const size_t rest = length - 20 - json_bytes;
    if (rest != 0) {
        const size_t chunk = 20 + json_bytes;
        if (rest < 8 || word_at(bytes, chunk) > rest - 8)
            throw input_error("{}: second GLB chunk does not fit into the file", file);
        if (word_at(bytes, chunk + 4) != kBinary)
            throw input_error("{}: second GLB chunk is of type {:#x}, expected BIN", file,
                              word_at(bytes, chunk + 4));
    }
    return {reinterpret_cast<const char*>(&bytes[20]), json_bytes};
}

void check_json(std::string_view json, const std::string& file) {
    // Look for the object that every glTF is, past a byte order mark and white space.
    const size_t start = json.find_first_not_of("\xef\xbb\xbf \t\r\n");
    if (start == std::string_view::npos || json[start] != '{')
        throw input_error("{}: neither a GLB nor a JSON object, expected glTF", file);
    int depth = 0;
    bool in_string = false;
    for (size_t i = start; i < json.size(); ++i) {
        const char c = json[i];
        if (in_string && c == '\\')
            ++i;
        else if (c == '"')
            in_string = !in_string;
        else if (!in_string && (c == '{' || c == '['))
            ++depth;
        else if (!in_string && (c == '}' || c == ']'))
            --depth;
        if (depth > kMaxNesting)
            throw input_error("{}: JSON nested deeper than {} levels", file, kMaxNesting);
    }
}

// --- Callbacks of tinygltf ---------------------------------------------------------------------

// tinygltf also tries the working directory; only the folder of the glTF counts.
bool file_exists(const std::string& path, void* user) {
    const std::string& folder = static_cast<const FileAccess*>(user)->folder;
    std::error_code ignored;
    return path.starts_with(folder) && std::filesystem::is_regular_file(path, ignored);
}

std::string same_path(const std::string& path, void*) {
    return path;
}

bool read_whole_file(std::vector<unsigned char>* out, std::string* error, const std::string& path,
                     void* user) {
    try {
        const auto bytes = read_file(path, static_cast<const FileAccess*>(user)->max_bytes);
        const auto* first = reinterpret_cast<const unsigned char*>(bytes.data());
        out->assign(first, first + bytes.size());
        return true;
    } catch (const Error& problem) {
        *error = problem.what();
        return false;
    }
}

bool refuse_to_write(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
}

// Keeps the bytes of images in files and data URIs. Those in buffer views stay there: at this
// point tinygltf has not checked that the view lies inside its buffer.
bool keep_image_bytes(tinygltf::Image* image, int, std::string*, std::string*, int, int,
                      const unsigned char* bytes, int size, void*) {
    if (image->bufferView < 0 && size > 0) image->image.assign(bytes, bytes + size);
    return true;
}

// --- Errors --------------------------------------------------------------------------------------

std::string short_line(const std::string& text) {
    std::string line = text.substr(0, text.find('\n'));
    if (line.size() > kMaxMessage) line = line.substr(0, kMaxMessage) + "...";
    return line.empty() ? "malformed glTF" : line;
}

// A buffer without a source of its own must be the first one of a GLB; tinygltf would hand the
// binary chunk to any.
void check_buffers(const tinygltf::Model& model, bool is_glb, const std::string& file) {
    for (size_t i = 0; i < model.buffers.size(); ++i) {
        const tinygltf::Buffer& buffer = model.buffers[i];
        if (!buffer.uri.empty()) continue;
        if (is_glb && i == 0 && !buffer.extensions.contains("EXT_meshopt_compression")) continue;
        check_compression(model, file);
        throw input_error("{}: buffer {} has no data", file, i);
    }
}

} // namespace

std::shared_ptr<const tinygltf::Model> read_gltf_file(const std::string& path,
                                                      const GltfLoadConfig& config) {
    // Check the container before it is parsed.
    const std::string file = input_name(path);
    const std::vector<std::byte> bytes = read_file(path, config.max_file_bytes);
    if (bytes.empty()) throw input_error("{}: empty file, expected glTF", file);
    if (bytes.size() > UINT32_MAX) throw input_error("{}: more than 4 GiB", file);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const bool is_glb = text.starts_with("glTF");
    check_json(is_glb ? glb_json(bytes, file) : text, file);

    // Parse, with file access and images in our hands.
    FileAccess access = {folder_of(path), config.max_file_bytes};
    tinygltf::TinyGLTF parser;
    parser.SetFsCallbacks({file_exists, same_path, read_whole_file, refuse_to_write, &access});
    parser.SetImageLoader(keep_image_bytes, nullptr);
    auto model = std::make_shared<tinygltf::Model>();
    std::string problem;
    std::string remarks;
    bool parsed = false;
    try {
        parsed =
            is_glb
                ? parser.LoadBinaryFromMemory(model.get(), &problem, &remarks,
                                              reinterpret_cast<const unsigned char*>(text.data()),
                                              unsigned(text.size()), access.folder)
                : parser.LoadASCIIFromString(model.get(), &problem, &remarks, text.data(),
                                             unsigned(text.size()), access.folder);
    } catch (const std::exception& exception) {
        problem = exception.what();
    }

    // A version or extension that we lack explains more than what tinygltf stumbled over.
    check_asset(*model, file);
    if (!parsed) {
        check_compression(*model, file);
        throw input_error("{}: {}", file, short_line(problem));
    }
    check_buffers(*model, is_glb, file);
    return model;
}

} // namespace ql
