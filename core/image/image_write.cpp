#include "image/image_file.h"

#include "base/check.h"
#include "base/error.h"
#include "image/atomic_file.h"
#include "image/exr_write.h"
#include "image/png_codec.h"
#include "image/png_metadata.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <new>
#include <system_error>

namespace ql {

namespace {

// IEC 61966-2-1, of values up to 1.
float srgb_encoded(float x) {
    return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
}

float png_sample(float value, const ImageWriteConfig& config) {
    if (std::isnan(value)) return 0;
    if (config.png != PngEncoding::srgb8) return value;
    const float exposed = std::max(0.0f, value * std::exp2(config.exposure_stops));
    return srgb_encoded(std::min(exposed, 1.0f));
}

// PNG holds one to four channels: R, G, B (and A), or the only plane there is.
std::vector<const Plane<float>*> png_planes(const Image& image, const std::string& path) {
    std::vector<const Plane<float>*> chosen;
    for (const char* name : {"R", "G", "B", "A"})
        for (const Plane<float>& plane : image.planes)
            if (plane.name == name) chosen.push_back(&plane);
    if (chosen.empty() && image.planes.size() <= 2)
        for (const Plane<float>& plane : image.planes)
            chosen.push_back(&plane);
    if (chosen.empty())
        throw output_error("{}: PNG cannot hold the channels {}; write EXR", output_name(path),
                           image.channel_names());
    return chosen;
}

std::vector<uint16_t> png_samples(const std::vector<const Plane<float>*>& planes,
                                  const ImageWriteConfig& config) {
    const size_t channels = planes.size();
    const size_t pixels = planes.front()->pixels.size();
    const float top = config.png == PngEncoding::linear16 ? 65535.0f : 255.0f;
    std::vector<uint16_t> samples(pixels * channels);
    for (size_t c = 0; c < channels; ++c)
        for (size_t i = 0; i < pixels; ++i) {
            const float value = png_sample(planes[c]->pixels[i], config);
            samples[i * channels + c] = uint16_t(std::lround(std::clamp(value, 0.0f, 1.0f) * top));
        }
    return samples;
}

PngDate png_date(const std::string& date_time) {
    PngDate date;
    std::sscanf(date_time.c_str(), "%d:%d:%d %d:%d:%d", &date.year, &date.month, &date.day,
                &date.hour, &date.minute, &date.second);
    return date;
}

std::vector<std::byte> encoded_png(const Image& image, const ImageWriteConfig& config,
                                   const std::string& path) {
    const std::vector<const Plane<float>*> planes = png_planes(image, path);
    const PngHeader header = {image.width, image.height, int(planes.size()),
                              config.png == PngEncoding::linear16 ? 16 : 8,
                              png_text(image, config.software)};
    const PngTransfer transfer =
        config.png == PngEncoding::srgb8 ? PngTransfer::srgb : PngTransfer::linear;
    return png_bytes(header, png_samples(planes, config), transfer, png_date(config.date_time));
}

void check_half_range(const Plane<float>& plane, const std::string& path) {
    // From here on rounding to half gives infinity
    constexpr float kHalfOverflow = 65520.0f;
    for (const float value : plane.pixels.values())
        if (std::isfinite(value) && std::abs(value) >= kHalfOverflow)
            throw output_error("{}: channel {} has the value {}, half floats end at 65504",
                               output_name(path), plane.name, value);
}

void check_parts(std::span<const Image> parts, FileFormat format, const ImageWriteConfig& config,
                 const std::string& path) {
    QL_CHECK(!parts.empty());
    for (const Image& part : parts) {
        QL_CHECK(part.channel_count() > 0);
        for (const auto& plane : part.planes)
            QL_CHECK_EQ(plane.pixels.size(), size_t(part.width) * size_t(part.height));
        for (const auto& plane : part.uint_planes)
            QL_CHECK_EQ(plane.pixels.size(), size_t(part.width) * size_t(part.height));
        if (format == FileFormat::exr && exr_is_half(part, config))
            for (const auto& plane : part.planes)
                check_half_range(plane, path);
    }
    if (parts.size() > 1 && format == FileFormat::png)
        throw usage_error("{}: PNG holds one part, {} are to be written; write EXR",
                          output_name(path), parts.size());
}

} // namespace

FileFormat file_format(const std::string& path, FileFormat requested) {
    const auto ends_with = [&](std::string_view ending) {
        return path.size() >= ending.size() &&
               std::equal(ending.rbegin(), ending.rend(), path.rbegin(),
                          [](char a, char b) { return a == char(std::tolower(b)); });
    };
    const FileFormat named = ends_with(".exr")   ? FileFormat::exr
                             : ends_with(".png") ? FileFormat::png
                                                 : FileFormat::by_extension;
    if (requested != FileFormat::by_extension && named != FileFormat::by_extension &&
        requested != named)
        throw usage_error("{}: to be written as {}, but the name says otherwise", path,
                          requested == FileFormat::exr ? "EXR" : "PNG");
    if (requested != FileFormat::by_extension) return requested;
    if (named != FileFormat::by_extension) return named;
    if (path == "-") throw usage_error("--format exr|png is needed to write to standard output");
    throw usage_error("{}: unknown image format, expected .exr or .png", path);
}

void write_image_parts(const std::string& path, std::span<const Image> parts,
                       const ImageWriteConfig& config) {
    const FileFormat format = file_format(path, config.format);
    check_parts(parts, format, config, path);
    std::vector<std::byte> bytes;
    try {
        bytes = format == FileFormat::exr ? exr_bytes(parts, config)
                                          : encoded_png(parts[0], config, path);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::system_error&) { // no thread to be had
        throw;
    } catch (const std::exception& problem) { // what the library did not expect
        throw output_error("{}: {}", output_name(path), first_line(problem.what()));
    }
    write_file(path, bytes);
}

void write_image(const std::string& path, const Image& image, const ImageWriteConfig& config) {
    write_image_parts(path, std::span(&image, 1), config);
}

} // namespace ql
