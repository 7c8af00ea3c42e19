#include "image/picture_decode.h"

#include "base/error.h"
#include "image/jpeg_decode.h"
#include "image/png_check.h"
#include "image/png_codec.h"

#include <webp/decode.h>

#include <algorithm>
#include <new>
#include <string_view>
#include <system_error>

namespace ql {

namespace {

std::string_view text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// One to four samples a pixel (grey, grey + alpha, RGB, RGBA) spread to four.
std::vector<uint8_t> spread_to_rgba(std::vector<uint8_t> samples, int channel_count) {
    if (channel_count == 4) return samples;
    const auto channels = size_t(channel_count);
    std::vector<uint8_t> rgba(samples.size() / channels * 4);
    const bool grey = channels < 3;
    for (size_t i = 0; i < rgba.size() / 4; ++i) {
        const uint8_t* in = &samples[i * channels];
        uint8_t* out = &rgba[i * 4];
        for (size_t c = 0; c < 3; ++c)
            out[c] = in[grey ? 0 : c];
        out[3] = channels == 2 ? in[1] : uint8_t(255);
    }
    return rgba;
}

// libjpeg fills what is missing with grey and says nothing. The end marker cannot occur within
// compressed data; some bytes after it are common.
void check_jpeg_end(std::span<const std::byte> bytes, const std::string& name) {
    constexpr size_t kMaxTrailing = 65536;
    const std::string_view end = text_of(bytes.last(std::min(bytes.size(), kMaxTrailing)));
    if (end.rfind("\xff\xd9") == std::string_view::npos)
        throw input_error("{}: truncated JPEG of {} bytes", name, bytes.size());
}

void check_size(int width, int height, const std::string& name, const PictureDecodeConfig& config) {
    if (size_t(width) * size_t(height) > config.max_pixels)
        throw input_error("{}: {} x {} pixels, more than the limit of {}", name, width, height,
                          config.max_pixels);
}

Picture decode_png(std::span<const std::byte> bytes, const std::string& name,
                   const PictureDecodeConfig& config) {
    const std::vector<std::byte> bare = bare_png(bytes, name);
    PngReader reader(bare, name);
    const PngHeader& header = reader.header();
    check_size(header.width, header.height, name, config);
    std::vector<uint8_t> samples;
    if (header.bits == 8) {
        samples = reader.samples8();
    } else {
        constexpr float kScale = 1.0f / 65535.0f;
        for (const uint16_t sample : reader.samples16())
            samples.push_back(uint8_t(float(sample) * kScale * 255.0f + 0.5f));
    }
    return {header.width, header.height, spread_to_rgba(std::move(samples), header.channels)};
}

Picture decode_jpeg_picture(std::span<const std::byte> bytes, const std::string& name,
                            const PictureDecodeConfig& config) {
    check_jpeg_end(bytes, name);
    JpegImage image = decode_jpeg(bytes, name, config.max_pixels);
    return {image.width, image.height, spread_to_rgba(std::move(image.samples), image.channels)};
}

Picture decode_webp(std::span<const std::byte> bytes, const std::string& name,
                    const PictureDecodeConfig& config) {
    const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(data, bytes.size(), &features) != VP8_STATUS_OK)
        throw input_error("{}: damaged WebP", name);
    if (features.has_animation)
        throw input_error("{}: an animated WebP, expected a still picture", name);
    check_size(features.width, features.height, name, config);
    Picture picture = {features.width, features.height, {}};
    picture.rgba.resize(size_t(picture.width) * size_t(picture.height) * 4);
    if (!WebPDecodeRGBAInto(data, bytes.size(), picture.rgba.data(), picture.rgba.size(),
                            picture.width * 4))
        throw input_error("{}: damaged WebP", name);
    return picture;
}

using Decoder = Picture(std::span<const std::byte> bytes, const std::string& name,
                        const PictureDecodeConfig& config);

struct Magic {
    std::string_view bytes;
    size_t offset;
    Decoder* decoder; // nothing: known, but not read
    const char* name;
};

constexpr Magic kMagics[] = {
    {"\x89PNG\r\n\x1a\n", 0, decode_png, "PNG"},
    {"\xff\xd8\xff", 0, decode_jpeg_picture, "JPEG"},
    {"WEBP", 8, decode_webp, "WebP"},
    {"BM", 0, nullptr, "BMP"},
    {"GIF8", 0, nullptr, "GIF"},
    {{"II*\0", 4}, 0, nullptr, "TIFF"},
    {{"MM\0*", 4}, 0, nullptr, "TIFF"},
    {"DDS ", 0, nullptr, "DDS"},
    {"\xabKTX 20", 0, nullptr, "KTX2"},
    {"\xabKTX 11", 0, nullptr, "KTX"},
};

const Magic& recognised(std::span<const std::byte> bytes, const std::string& name) {
    if (bytes.empty()) throw input_error("{}: empty, expected an image", name);
    const std::string_view text = text_of(bytes);
    for (const Magic& magic : kMagics)
        if (text.size() >= magic.offset &&
            text.substr(magic.offset, magic.bytes.size()) == magic.bytes) {
            if (!magic.decoder)
                throw input_error("{}: {} images are not supported, expected PNG or JPEG", name,
                                  magic.name);
            return magic;
        }
    throw input_error("{}: unknown image format, expected PNG or JPEG", name);
}

} // namespace

Picture decode_picture(std::span<const std::byte> bytes, const std::string& name,
                       const PictureDecodeConfig& config) {
    return recognised(bytes, name).decoder(bytes, name, config);
}

} // namespace ql
