#include "image/image_file.h"

#include "base/error.h"
#include "image/atomic_file.h"
#include "image/exr_parts.h"

#include <OpenEXR/OpenEXRConfig.h>
#include <OpenImageIO/color.h>
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

namespace ql {

namespace {

// CIE 1931 xy of the Rec. 709 primaries and D65, in the order of the OpenEXR attribute.
constexpr float kRec709[8] = {0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};

// Header entries that the library computes or that belong to the container, not to our image.
const std::set<std::string> kContainerKeys = {"oiio:ColorSpace",
                                              "oiio:subimages",
                                              "oiio:subimagename",
                                              "oiio:BitsPerSample",
                                              "openexr:levelmode",
                                              "openexr:lineOrder",
                                              "openexr:chunkCount",
                                              "name",
                                              "type",
                                              "version",
                                              "DateTime",
                                              "compression",
                                              "chromaticities",
                                              "PixelAspectRatio",
                                              "screenWindowWidth",
                                              "screenWindowCenter",
                                              "openexr:dwaCompressionLevel"};

std::string shown_name(const std::string& path) {
    return path == "-" ? "standard input" : path;
}

// OpenImageIO's messages may run over several lines; ours is one.
std::string first_line(std::string text) {
    text = text.substr(0, text.find('\n'));
    return text.empty() ? "malformed" : text;
}

FileFormat format_of(const std::vector<std::byte>& bytes, const std::string& path) {
    const auto starts_with = [&](std::initializer_list<int> magic) {
        return bytes.size() >= magic.size() &&
               std::equal(magic.begin(), magic.end(), bytes.begin(),
                          [](int m, std::byte b) { return std::byte(m) == b; });
    };
    if (bytes.empty()) throw input_error("{}: empty file, expected an image", shown_name(path));
    if (starts_with({0x76, 0x2f, 0x31, 0x01})) return FileFormat::exr;
    if (starts_with({0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'})) return FileFormat::png;
    throw input_error("{}: neither OpenEXR nor PNG", shown_name(path));
}

const char* library_name(FileFormat format) {
    return format == FileFormat::exr ? "openexr" : "png";
}

// bytes: what the parts before this one take, to which this one is added.
void check_size(const OIIO::ImageSpec& spec, const std::string& path, size_t& bytes,
                const ImageReadConfig& config) {
    if (spec.width <= 0 || spec.height <= 0 || spec.depth > 1)
        throw input_error("{}: {} x {} x {} pixels, expected a flat image", shown_name(path),
                          spec.width, spec.height, spec.depth);
    const size_t pixels = size_t(spec.width) * size_t(spec.height);
    bytes += pixels * size_t(spec.nchannels) * 4;
    if (pixels > config.max_pixels || bytes > config.max_bytes)
        throw input_error("{}: {} x {} pixels of {} channels, more than the limit of {} pixels or "
                          "{} bytes",
                          shown_name(path), spec.width, spec.height, spec.nchannels,
                          config.max_pixels, config.max_bytes);
    if (spec.deep) throw input_error("{}: a deep image, expected a flat one", shown_name(path));
}

void read_metadata(const OIIO::ImageSpec& spec, Image& image) {
    for (const OIIO::ParamValue& entry : spec.extra_attribs) {
        const std::string key = entry.name().string();
        if (kContainerKeys.contains(key)) continue;
        if (entry.type() == OIIO::TypeInt)
            image.metadata[key] = entry.get<int>();
        else if (entry.type() == OIIO::TypeFloat)
            image.metadata[key] = entry.get<float>();
        else if (entry.type() == OIIO::TypeString)
            image.metadata[key] = entry.get<OIIO::ustring>().string();
        else if (entry.type() == OIIO::TypeMatrix)
            image.metadata[key] = *static_cast<const Imath::M44f*>(entry.data());
        else if (entry.type().basetype == OIIO::TypeDesc::FLOAT) {
            const auto* values = static_cast<const float*>(entry.data());
            image.metadata[key] = std::vector<float>(
                values, values + entry.type().numelements() * size_t(entry.type().aggregate));
        }
    }
}

size_t image_pixels(const OIIO::ImageSpec& spec) {
    return size_t(spec.width) * size_t(spec.height);
}

bool is_word(const OIIO::ImageSpec& spec, int channel) {
    return spec.channelformat(channel).basetype == OIIO::TypeDesc::UINT32;
}

// Takes every `stride`-th word from `offset` on as the plane of a channel.
void store_channel(const std::vector<uint32_t>& words, size_t offset, size_t stride,
                   const OIIO::ImageSpec& spec, int channel, Image& image) {
    const auto take = [&](auto& values) {
        for (size_t i = 0; i < values.size(); ++i)
            std::memcpy(&values[i], &words[i * stride + offset], sizeof(uint32_t));
    };
    if (is_word(spec, channel))
        take(image.uint_plane(spec.channel_name(channel)).values());
    else
        take(image.plane(spec.channel_name(channel)).values());
}

Image read_part(OIIO::ImageInput& input, int part, const std::string& path,
                const ImageReadConfig& config) {
    const OIIO::ImageSpec spec = input.spec(part, 0);
    Image image(spec.width, spec.height);
    image.name = spec.get_string_attribute("oiio:subimagename");
    image.source_bits = int(spec.format.size()) * 8;
    read_metadata(spec, image);
    // Each call decodes the file anew, so take neighbouring channels of one kind together
    for (int first = 0; first < spec.nchannels;) {
        int end = first + 1;
        while (end < spec.nchannels && is_word(spec, end) == is_word(spec, first))
            ++end;
        std::vector<uint32_t> words(image_pixels(spec) * size_t(end - first));
        const OIIO::TypeDesc type =
            is_word(spec, first) ? OIIO::TypeDesc::UINT32 : OIIO::TypeDesc::FLOAT;
        if (!input.read_image(part, 0, first, end, type, words.data()))
            throw input_error("{}: {}", shown_name(path), first_line(input.geterror()));
        for (int c = first; c < end; ++c)
            store_channel(words, size_t(c - first), size_t(end - first), spec, c, image);
        first = end;
    }
    if (image.channel_count() != size_t(spec.nchannels))
        throw input_error("{}: two channels of the same name", shown_name(path));
    if (config.non_finite == NonFinite::reject) require_finite(image, path);
    return image;
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
        if (image.find("R"))
            spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), kRec709);
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
        throw output_error("{}: PNG cannot hold the channels {}; write EXR",
                           path == "-" ? "standard output" : path, image.channel_names());
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

void require_finite(const Image& image, const std::string& path) {
    for (const Plane<float>& plane : image.planes)
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                if (!std::isfinite(plane.pixels(x, y)))
                    throw input_error(
                        "{}: channel {} is {} at pixel {},{}, expected a finite value",
                        shown_name(path), plane.name, plane.pixels(x, y), x, y);
}

std::vector<Image> read_image_parts(const std::string& path, const ImageReadConfig& config) {
    const std::vector<std::byte> bytes = read_file(path, config.max_bytes);
    const FileFormat format = format_of(bytes, path);
    OIIO::Filesystem::IOMemReader memory(const_cast<std::byte*>(bytes.data()), bytes.size());
    auto input = OIIO::ImageInput::create(library_name(format));
    OIIO::ImageSpec request;
    void* proxy = &memory;
    request.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    request.attribute("oiio:UnassociatedAlpha", 1);
    OIIO::ImageSpec spec;
    if (!input || !input->open(path, spec, request))
        throw input_error("{}: {}", shown_name(path),
                          first_line(input ? input->geterror() : OIIO::geterror()));
    std::vector<Image> parts;
    size_t total_bytes = 0;
    for (int part = 0; input->seek_subimage(part, 0); ++part) {
        check_size(input->spec(part, 0), path, total_bytes, config);
        parts.push_back(read_part(*input, part, path, config));
    }
    (void)input->geterror(); // seeking past the last part leaves a message behind
    input->close();
    return parts;
}

Image read_image(const std::string& path, const ImageReadConfig& config) {
    std::vector<Image> parts = read_image_parts(path, config);
    if (parts.size() != 1)
        throw input_error("{}: {} parts, expected one", shown_name(path), parts.size());
    return std::move(parts.front());
}

void write_image_parts(const std::string& path, std::span<const Image> parts,
                       const ImageWriteConfig& config) {
    const FileFormat format = file_format(path, config.format);
    check_parts(parts, format, config, path);
    if (parts.size() > 1) {
        const std::vector<char> file = exr_parts(parts, config);
        return write_file(path, std::as_bytes(std::span(file)));
    }
    std::vector<unsigned char> bytes;
    {
        OIIO::Filesystem::IOVecOutput memory(bytes);
        auto output = OIIO::ImageOutput::create(library_name(format));
        std::vector<const Plane<float>*> planes;
        if (format == FileFormat::png) planes = png_planes(parts.front(), path);
        const OIIO::ImageSpec spec = format == FileFormat::png
                                         ? png_spec(parts.front(), planes, config)
                                         : write_spec(parts.front(), format, config);
        if (!output || !output->set_ioproxy(&memory))
            throw output_error("{}: the image library cannot write to memory", path);
        bool good = output->open("memory", spec);
        good = good && (format == FileFormat::png ? write_png_pixels(*output, planes, config)
                                                  : write_exr_pixels(*output, parts.front()));
        good = good && output->close();
        if (!good) throw output_error("{}: {}", path, first_line(output->geterror()));
    }
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
