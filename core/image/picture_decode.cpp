#include "image/picture_decode.h"

#include "base/error.h"
#include "image/memory_reader.h"
#include "image/png_check.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <string_view>
#include <system_error>

namespace ql {

namespace {

struct Magic {
    std::string_view bytes;
    size_t offset;
    const char* reader; // OpenImageIO's name; nothing: known, but not read
    const char* name;
};

constexpr Magic kMagics[] = {
    {"\x89PNG\r\n\x1a\n", 0, "png", "PNG"},
    {"\xff\xd8\xff", 0, "jpeg", "JPEG"},
    {"WEBP", 8, "webp", "WebP"},
    {"BM", 0, nullptr, "BMP"},
    {"GIF8", 0, nullptr, "GIF"},
    {{"II*\0", 4}, 0, nullptr, "TIFF"},
    {{"MM\0*", 4}, 0, nullptr, "TIFF"},
    {"DDS ", 0, nullptr, "DDS"},
    {"\xabKTX 20", 0, nullptr, "KTX2"},
    {"\xabKTX 11", 0, nullptr, "KTX"},
};

std::string_view text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

const Magic& recognised(std::span<const std::byte> bytes, const std::string& name) {
    if (bytes.empty()) throw input_error("{}: empty, expected an image", name);
    const std::string_view text = text_of(bytes);
    for (const Magic& magic : kMagics)
        if (text.size() >= magic.offset &&
            text.substr(magic.offset, magic.bytes.size()) == magic.bytes) {
            if (!magic.reader)
                throw input_error("{}: {} images are not supported, expected PNG or JPEG", name,
                                  magic.name);
            return magic;
        }
    throw input_error("{}: unknown image format, expected PNG or JPEG", name);
}

// libjpeg fills what is missing with grey and says nothing. The end marker cannot occur within
// compressed data; some bytes after it are common.
void check_jpeg_end(std::span<const std::byte> bytes, const std::string& name) {
    constexpr size_t kMaxTrailing = 65536;
    const std::string_view end = text_of(bytes.last(std::min(bytes.size(), kMaxTrailing)));
    if (end.rfind("\xff\xd9") == std::string_view::npos)
        throw input_error("{}: truncated JPEG of {} bytes", name, bytes.size());
}

std::string reason(const std::string& message) {
    const std::string line = message.substr(0, message.find('\n'));
    return line.empty() ? "cannot be decoded" : line;
}

void check_size(const OIIO::ImageSpec& spec, const std::string& name,
                const PictureDecodeConfig& config) {
    if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1 || spec.nchannels < 1)
        throw input_error("{}: {} x {} pixels of {} channels, expected a flat image", name,
                          spec.width, spec.height, spec.nchannels);
    if (size_t(spec.width) * size_t(spec.height) > config.max_pixels)
        throw input_error("{}: {} x {} pixels, more than the limit of {}", name, spec.width,
                          spec.height, config.max_pixels);
}

// One to four samples a pixel (grey, grey + alpha, RGB, RGBA) spread to four.
std::vector<uint8_t> spread_to_rgba(const std::vector<uint8_t>& samples, size_t pixels,
                                    size_t channels) {
    std::vector<uint8_t> rgba(pixels * 4);
    const bool grey = channels < 3;
    for (size_t i = 0; i < pixels; ++i) {
        const uint8_t* in = &samples[i * channels];
        uint8_t* out = &rgba[i * 4];
        for (size_t c = 0; c < 3; ++c)
            out[c] = in[grey ? 0 : c];
        out[3] = channels == 2 ? in[1] : channels == 4 ? in[3] : uint8_t(255);
    }
    return rgba;
}

Picture decoded(std::span<const std::byte> bytes, const Magic& magic, const std::string& name,
                const PictureDecodeConfig& config) {
    // Open the bytes as if they were a file.
    MemoryReader memory(bytes);
    void* proxy = &memory;
    OIIO::ImageSpec request;
    request.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    request.attribute("oiio:UnassociatedAlpha", 1);
    OIIO::ImageSpec spec;
    const auto input = OIIO::ImageInput::create(magic.reader);
    if (!input || !input->supports("ioproxy"))
        throw input_error("{}: this build cannot read {} images", name, magic.name);
    if (!input->open(name, spec, request))
        throw input_error("{}: {}", name, reason(input->geterror()));
    check_size(spec, name, config);

    // Read at most four channels as 8-bit samples.
    const size_t channels = size_t(std::min(spec.nchannels, 4));
    const size_t pixels = size_t(spec.width) * size_t(spec.height);
    std::vector<uint8_t> samples(pixels * channels);
    if (!input->read_image(0, 0, 0, int(channels), OIIO::TypeDesc::UINT8, samples.data()))
        throw input_error("{}: {}", name, reason(input->geterror()));
    input->close();
    return {spec.width, spec.height,
            channels == 4 ? std::move(samples) : spread_to_rgba(samples, pixels, channels)};
}

} // namespace

Picture decode_picture(std::span<const std::byte> bytes, const std::string& name,
                       const PictureDecodeConfig& config) {
    const Magic& magic = recognised(bytes, name);

    // libpng prints what it thinks of profiles and the like, which matter to no texture.
    std::vector<std::byte> bare;
    if (std::string_view(magic.name) == "PNG") {
        bare = bare_png(bytes, name);
        bytes = bare;
    }

    if (std::string_view(magic.name) == "JPEG") check_jpeg_end(bytes, name);

    try {
        return decoded(bytes, magic, name, config);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::system_error&) { // no thread to be had: not the picture's fault
        throw;
    } catch (const std::exception& problem) { // what the library did not expect either
        throw input_error("{}: {}", name, reason(problem.what()));
    }
}

} // namespace ql
