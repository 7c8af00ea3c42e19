#include "image/image_file.h"

#include "base/error.h"
#include "image/atomic_file.h"
#include "image/exr_check.h"
#include "image/memory_reader.h"
#include "image/png_check.h"

#include <OpenImageIO/imageio.h>

#include <cmath>
#include <cstring>
#include <set>
#include <system_error>

namespace ql {

namespace {

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

} // namespace

void require_finite(const Image& image, const std::string& path) {
    for (const Plane<float>& plane : image.planes)
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                if (!std::isfinite(plane.pixels(x, y)))
                    throw input_error(
                        "{}: channel {} is {} at pixel {},{}, expected a finite value",
                        shown_name(path), plane.name, plane.pixels(x, y), x, y);
}

namespace {

std::vector<Image> decoded_parts(std::span<const std::byte> bytes, FileFormat format,
                                 const std::string& path, const ImageReadConfig& config) {
    MemoryReader memory(bytes);
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

} // namespace

std::vector<Image> read_image_parts(const std::string& path, const ImageReadConfig& config) {
    const std::vector<std::byte> bytes = read_file(path, config.max_bytes);
    const FileFormat format = format_of(bytes, path);
    if (format == FileFormat::png) check_png(bytes, shown_name(path));
    if (format == FileFormat::exr)
        check_exr(bytes, shown_name(path), {config.max_pixels, config.max_bytes});
    try {
        return decoded_parts(bytes, format, path, config);
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::system_error&) { // no thread to be had: not the file's fault
        throw;
    } catch (const std::exception& problem) { // what the library did not expect either
        throw input_error("{}: {}", shown_name(path), first_line(problem.what()));
    }
}

Image read_image(const std::string& path, const ImageReadConfig& config) {
    std::vector<Image> parts = read_image_parts(path, config);
    if (parts.size() != 1)
        throw input_error("{}: {} parts, expected one", shown_name(path), parts.size());
    return std::move(parts.front());
}

} // namespace ql
