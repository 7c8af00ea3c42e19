#include "image/image_file.h"

#include "base/error.h"
#include "image/atomic_file.h"
#include "image/exr_check.h"
#include "image/exr_read.h"
#include "image/png_check.h"
#include "image/png_codec.h"
#include "image/png_metadata.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <system_error>

namespace ql {

namespace {

FileFormat format_of(const std::vector<std::byte>& bytes, const std::string& path) {
    const auto starts_with = [&](std::initializer_list<int> magic) {
        return bytes.size() >= magic.size() &&
               std::equal(magic.begin(), magic.end(), bytes.begin(),
                          [](int m, std::byte b) { return std::byte(m) == b; });
    };
    if (bytes.empty()) throw input_error("{}: empty file, expected an image", input_name(path));
    if (starts_with({0x76, 0x2f, 0x31, 0x01})) return FileFormat::exr;
    if (starts_with({0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'})) return FileFormat::png;
    throw input_error("{}: neither OpenEXR nor PNG", input_name(path));
}

template<class T>
void store_samples(const std::vector<T>& samples, float scale, Image& image) {
    const size_t channels = image.planes.size();
    for (size_t c = 0; c < channels; ++c)
        for (size_t i = 0; i < image.planes[c].pixels.size(); ++i)
            image.planes[c].pixels[i] = float(samples[i * channels + c]) * scale;
}

Image read_png(std::span<const std::byte> bytes, const std::string& name,
               const ImageReadConfig& config) {
    PngReader reader(bytes, name);
    const PngHeader& header = reader.header();
    const size_t pixels = size_t(header.width) * size_t(header.height);
    if (pixels > config.max_pixels || header.sample_count() * sizeof(float) > config.max_bytes)
        throw input_error("{}: {} x {} pixels of {} channels, more than the limit of {} pixels or "
                          "{} bytes",
                          name, header.width, header.height, header.channels, config.max_pixels,
                          config.max_bytes);
    Image image(header.width, header.height);
    image.source_bits = header.bits;
    read_png_text(header.text, image);
    constexpr std::string_view kGrey[] = {"Y", "A"}, kColour[] = {"R", "G", "B", "A"};
    for (size_t c = 0; c < size_t(header.channels); ++c)
        image.plane(header.channels < 3 ? kGrey[c] : kColour[c]);
    if (header.bits == 8)
        store_samples(reader.samples8(), 1.0f / 255.0f, image);
    else
        store_samples(reader.samples16(), 1.0f / 65535.0f, image);
    return image;
}

} // namespace

void require_finite(const Image& image, const std::string& path) {
    for (const Plane<float>& plane : image.planes)
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                if (!std::isfinite(plane.pixels(x, y)))
                    throw input_error(
                        "{}: channel {} is {} at pixel {},{}, expected a finite value",
                        input_name(path), plane.name, plane.pixels(x, y), x, y);
}

std::vector<Image> read_image_parts(const std::string& path, const ImageReadConfig& config) {
    const std::vector<std::byte> bytes = read_file(path, config.max_bytes);
    const FileFormat format = format_of(bytes, path);
    const std::string name = input_name(path);
    try {
        if (format == FileFormat::exr) {
            check_exr(bytes, name, {config.max_pixels, config.max_bytes});
            return read_exr(bytes, name, config);
        }
        check_png(bytes, name);
        return {read_png(bytes, name, config)};
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::system_error&) { // no thread to be had: not the file's fault
        throw;
    } catch (const std::exception& problem) { // what the library did not expect either
        throw input_error("{}: {}", name, first_line(problem.what()));
    }
}

Image read_image(const std::string& path, const ImageReadConfig& config) {
    std::vector<Image> parts = read_image_parts(path, config);
    if (parts.size() != 1)
        throw input_error("{}: {} parts, expected one", input_name(path), parts.size());
    return std::move(parts.front());
}

} // namespace ql
