#include "image/image_file.h"

#include "base/error.h"
#include "image/atomic_file.h"

#include <OpenEXR/OpenEXRConfig.h>
#include <OpenImageIO/color.h>
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace ql {

namespace {

// CIE 1931 xy of the Rec. 709 primaries and D65, in the order of the OpenEXR attribute.
constexpr float kRec709[8] = {0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};
const OIIO::TypeDesc kChromaticitiesType(OIIO::TypeDesc::FLOAT, 8);

std::string shown_name(const std::string& path) {
    return path == "-" ? "standard output" : path;
}

// OpenImageIO's messages may run over several lines; ours is one.
std::string first_line(std::string text) {
    text = text.substr(0, text.find('\n'));
    return text.empty() ? "malformed" : text;
}

const char* library_name(FileFormat format) {
    return format == FileFormat::exr ? "openexr" : "png";
}

// Words beside halves would need rows of mixed sample sizes; such files keep full floats.
bool is_half(const Image& image, const ImageWriteConfig& config) {
    return config.depth == FloatDepth::half && image.uint_planes.empty();
}

OIIO::ImageSpec write_spec(const Image& image, FileFormat format, const ImageWriteConfig& config) {
    const bool half = is_half(image, config);
    OIIO::ImageSpec spec(image.width, image.height, int(image.channel_count()),
                         half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
    spec.channelnames.clear();
    for (const auto& plane : image.planes) {
        spec.channelnames.push_back(plane.name);
        spec.channelformats.push_back(spec.format);
    }
    for (const auto& plane : image.uint_planes) {
        spec.channelnames.push_back(plane.name);
        spec.channelformats.emplace_back(OIIO::TypeDesc::UINT32);
    }
    if (image.planes.empty()) spec.format = OIIO::TypeDesc::UINT32;
    if (image.planes.empty() || image.uint_planes.empty()) spec.channelformats.clear();
    spec.attribute("Software", config.software);
    spec.attribute("DateTime", config.date_time);
    if (!image.name.empty()) spec.attribute("oiio:subimagename", image.name);
    if (format == FileFormat::exr) {
        spec.attribute("compression", "zip");
        if (image.find("R")) spec.attribute("chromaticities", kChromaticitiesType, kRec709);
    }
    for (const auto& [key, value] : image.metadata) {
        if (key == "Software") continue;
        if (const auto* i = std::get_if<int>(&value)) spec.attribute(key, *i);
        if (const auto* f = std::get_if<float>(&value)) spec.attribute(key, *f);
        if (const auto* s = std::get_if<std::string>(&value)) spec.attribute(key, *s);
        if (const auto* m = std::get_if<Imath::M44f>(&value))
            spec.attribute(key, OIIO::TypeMatrix, m);
        if (const auto* v = std::get_if<std::vector<float>>(&value); v && !v->empty())
            spec.attribute(key, OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, int(v->size())), v->data());
    }
    return spec;
}

// Pixel-interleaved samples in the types of the spec: float planes first, then unsigned ones.
std::vector<uint32_t> interleaved(const Image& image) {
    const size_t channels = image.channel_count();
    std::vector<uint32_t> words(size_t(image.width) * size_t(image.height) * channels);
    size_t c = 0;
    for (const auto& plane : image.planes) {
        for (size_t i = 0; i < plane.pixels.size(); ++i)
            std::memcpy(&words[i * channels + c], &plane.pixels[i], sizeof(float));
        ++c;
    }
    for (const auto& plane : image.uint_planes) {
        for (size_t i = 0; i < plane.pixels.size(); ++i)
            words[i * channels + c] = plane.pixels[i];
        ++c;
    }
    return words;
}

bool write_exr_pixels(OIIO::ImageOutput& output, const Image& image) {
    const std::vector<uint32_t> words = interleaved(image);
    const bool mixed = !image.planes.empty() && !image.uint_planes.empty();
    const OIIO::TypeDesc type = mixed                  ? OIIO::TypeDesc()
                                : image.planes.empty() ? OIIO::TypeDesc(OIIO::TypeDesc::UINT32)
                                                       : OIIO::TypeDesc(OIIO::TypeDesc::FLOAT);
    return output.write_image(type, words.data());
}

float png_sample(float value, const ImageWriteConfig& config) {
    if (std::isnan(value)) return 0;
    if (config.png != PngEncoding::srgb8) return value;
    const float exposed = std::max(0.0f, value * std::exp2(config.exposure_stops));
    return OIIO::linear_to_sRGB(std::min(exposed, 1.0f));
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
        throw output_error("{}: PNG cannot hold the channels {}; write EXR", shown_name(path),
                           image.channel_names());
    return chosen;
}

bool write_png_pixels(OIIO::ImageOutput& output, const std::vector<const Plane<float>*>& planes,
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
    if (config.png == PngEncoding::linear16)
        return output.write_image(OIIO::TypeDesc::UINT16, samples.data());
    const std::vector<uint8_t> bytes(samples.begin(), samples.end());
    return output.write_image(OIIO::TypeDesc::UINT8, bytes.data());
}

OIIO::ImageSpec png_spec(const Image& image, const std::vector<const Plane<float>*>& planes,
                         const ImageWriteConfig& config) {
    const bool deep_colour = config.png == PngEncoding::linear16;
    OIIO::ImageSpec spec = write_spec(image, FileFormat::png, config);
    spec.nchannels = int(planes.size());
    spec.channelformats.clear();
    spec.channelnames.clear();
    for (const Plane<float>* plane : planes)
        spec.channelnames.push_back(plane->name);
    spec.set_format(deep_colour ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", config.png == PngEncoding::srgb8 ? "sRGB" : "Linear");
    // Planes are not associated with an alpha; nothing may be multiplied by it.
    spec.attribute("oiio:UnassociatedAlpha", 1);
    return spec;
}

void check_half_range(const Plane<float>& plane, const std::string& path) {
    // From here on rounding to half gives infinity
    constexpr float kHalfOverflow = 65520.0f;
    for (const float value : plane.pixels.values())
        if (std::isfinite(value) && std::abs(value) >= kHalfOverflow)
            throw output_error("{}: channel {} has the value {}, half floats end at 65504", path,
                               plane.name, value);
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
        if (format == FileFormat::exr && is_half(part, config))
            for (const auto& plane : part.planes)
                check_half_range(plane, path);
    }
    if (parts.size() > 1 && format == FileFormat::png)
        throw usage_error("{}: PNG holds one part, {} are to be written; write EXR", path,
                          parts.size());
}

Error write_failure(const OIIO::ImageOutput& output, const std::string& path) {
    return output_error("{}: {}", shown_name(path), first_line(output.geterror()));
}

std::vector<unsigned char> encoded_image(const Image& image, FileFormat format,
                                         const ImageWriteConfig& config, const std::string& path) {
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    const auto output = OIIO::ImageOutput::create(library_name(format));
    if (!output || !output->set_ioproxy(&memory))
        throw output_error("{}: the image library cannot write to memory", shown_name(path));
    const bool png = format == FileFormat::png;
    const auto planes = png ? png_planes(image, path) : std::vector<const Plane<float>*>();
    const OIIO::ImageSpec spec =
        png ? png_spec(image, planes, config) : write_spec(image, format, config);
    if (!output->open("memory", spec) ||
        !(png ? write_png_pixels(*output, planes, config) : write_exr_pixels(*output, image)) ||
        !output->close())
        throw write_failure(*output, path);
    return bytes;
}

// A file without a name. OpenImageIO 2.4 writes several parts by file name only.
class MemoryFile {
  public:
    MemoryFile() : m_descriptor(memfd_create("image", MFD_CLOEXEC)) {
        if (m_descriptor < 0) throw output_error("no memory for a file ({})", std::strerror(errno));
    }
    ~MemoryFile() { close(m_descriptor); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    std::string path() const { return fmt::format("/proc/self/fd/{}", m_descriptor); }

  private:
    int m_descriptor;
};

// OpenEXR wants the same display window and chromaticities in all parts of a file.
std::vector<OIIO::ImageSpec> part_specs(std::span<const Image> parts,
                                        const ImageWriteConfig& config) {
    std::vector<OIIO::ImageSpec> specs;
    int width = 0, height = 0;
    bool color = false;
    for (const Image& part : parts) {
        specs.push_back(write_spec(part, FileFormat::exr, config));
        width = std::max(width, part.width);
        height = std::max(height, part.height);
        color = color || part.find("R");
    }
    for (OIIO::ImageSpec& spec : specs) {
        spec.full_width = width;
        spec.full_height = height;
        if (color) spec.attribute("chromaticities", kChromaticitiesType, kRec709);
    }
    return specs;
}

std::vector<unsigned char> encoded_parts(std::span<const Image> parts,
                                         const ImageWriteConfig& config, const std::string& path) {
    const MemoryFile file;
    const std::vector<OIIO::ImageSpec> specs = part_specs(parts, config);
    const auto output = OIIO::ImageOutput::create(library_name(FileFormat::exr));
    if (!output || !output->open(file.path(), int(specs.size()), specs.data()))
        throw output ? write_failure(*output, path)
                     : output_error("{}: the image library has no OpenEXR", shown_name(path));
    for (size_t i = 0; i < parts.size(); ++i) {
        const bool open =
            i == 0 || output->open(file.path(), specs[i], OIIO::ImageOutput::AppendSubimage);
        if (!open || !write_exr_pixels(*output, parts[i])) throw write_failure(*output, path);
    }
    if (!output->close()) throw write_failure(*output, path);
    const std::vector<std::byte> bytes = read_file(file.path());
    const auto* first = reinterpret_cast<const unsigned char*>(bytes.data());
    return {first, first + bytes.size()};
}

} // namespace

FileFormat file_format(const std::string& path, FileFormat requested) {
    if (requested != FileFormat::by_extension) return requested;
    const auto ends_with = [&](std::string_view ending) {
        return path.size() >= ending.size() &&
               std::equal(ending.rbegin(), ending.rend(), path.rbegin(),
                          [](char a, char b) { return a == char(std::tolower(b)); });
    };
    if (ends_with(".exr")) return FileFormat::exr;
    if (ends_with(".png")) return FileFormat::png;
    if (path == "-") throw usage_error("--format exr|png is needed to write to standard output");
    throw usage_error("{}: unknown image format, expected .exr or .png", path);
}

void write_image_parts(const std::string& path, std::span<const Image> parts,
                       const ImageWriteConfig& config) {
    const FileFormat format = file_format(path, config.format);
    check_parts(parts, format, config, path);
    const std::vector<unsigned char> bytes = parts.size() == 1
                                                 ? encoded_image(parts[0], format, config, path)
                                                 : encoded_parts(parts, config, path);
    write_file(path, std::as_bytes(std::span(bytes)));
}

void write_image(const std::string& path, const Image& image, const ImageWriteConfig& config) {
    write_image_parts(path, std::span(&image, 1), config);
}

void set_image_threads(int threads) {
    OIIO::attribute("threads", threads);
    OIIO::attribute("exr_threads", threads);
}

std::string image_library_versions() {
    return fmt::format("OpenImageIO {}, OpenEXR {}", OIIO_VERSION_STRING, OPENEXR_VERSION_STRING);
}

} // namespace ql
