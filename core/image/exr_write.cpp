#include "image/exr_write.h"

#include "image/exr_metadata.h"
#include "image/exr_stream.h"
#include "image/exr_threads.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <fmt/format.h>

#include <algorithm>
#include <deque>

namespace ql {

namespace {

// The default is Rec. 709 with D65, which is what linear R, G, B are.
const Imf::Chromaticities kRec709;

// display: the window of the whole file.
Imf::Header header_of(const Image& image, const Imath::V2i& display,
                      const ImageWriteConfig& config) {
    Imf::Header header(display.x, display.y, {{0, 0}, {image.width - 1, image.height - 1}});
    header.compression() = Imf::ZIP_COMPRESSION;
    if (!image.name.empty()) header.setName(image.name);
    const Imf::PixelType type = exr_is_half(image, config) ? Imf::HALF : Imf::FLOAT;
    for (const auto& plane : image.planes)
        header.channels().insert(plane.name, Imf::Channel(type));
    for (const auto& plane : image.uint_planes)
        header.channels().insert(plane.name, Imf::Channel(Imf::UINT));
    if (!config.software.empty()) header.insert("Software", Imf::StringAttribute(config.software));
    header.insert("capDate", Imf::StringAttribute(config.date_time));
    insert_exr_metadata(image.metadata, header);
    return header;
}

// OpenEXR wants the same display window and chromaticities in all parts of a file, and names that
// differ.
std::vector<Imf::Header> headers_of(std::span<const Image> parts, const ImageWriteConfig& config) {
    Imath::V2i display(0);
    bool colour = false;
    for (const Image& part : parts) {
        display.x = std::max(display.x, part.width);
        display.y = std::max(display.y, part.height);
        colour = colour || part.find("R");
    }
    std::vector<Imf::Header> headers;
    for (const Image& part : parts) {
        headers.push_back(header_of(part, display, config));
        if (colour) headers.back().insert("chromaticities", Imf::ChromaticitiesAttribute(kRec709));
        if (parts.size() == 1) break; // such files have no type, and need no name
        headers.back().setType(Imf::SCANLINEIMAGE);
        if (part.name.empty())
            headers.back().setName(fmt::format("subimage{:02}", headers.size() - 1));
    }
    return headers;
}

// What the library reads of a part: its planes, or halves that are made of them.
class PartPixels {
  public:
    PartPixels(const Image& image, const ImageWriteConfig& config) {
        const auto add = [&](const std::string& name, Imf::PixelType type, const void* pixels) {
            m_buffer.insert(name,
                            Imf::Slice::Make(type, pixels, {0, 0}, image.width, image.height));
        };
        if (exr_is_half(image, config))
            for (const auto& plane : image.planes) {
                const auto& values = plane.pixels.values();
                add(plane.name, Imf::HALF,
                    m_halves.emplace_back(values.begin(), values.end()).data());
            }
        else
            for (const auto& plane : image.planes)
                add(plane.name, Imf::FLOAT, plane.pixels.values().data());
        for (const auto& plane : image.uint_planes)
            add(plane.name, Imf::UINT, plane.pixels.values().data());
    }

    const Imf::FrameBuffer& buffer() const { return m_buffer; }

  private:
    std::deque<std::vector<Imath::half>> m_halves;
    Imf::FrameBuffer m_buffer;
};

template<class Output>
void write_pixels(Output&& output, const Image& image, const ImageWriteConfig& config) {
    const PartPixels pixels(image, config);
    output.setFrameBuffer(pixels.buffer());
    output.writePixels(image.height);
}

} // namespace

// Words beside halves keep full floats.
bool exr_is_half(const Image& image, const ImageWriteConfig& config) {
    return config.depth == FloatDepth::half && image.uint_planes.empty();
}

std::vector<std::byte> exr_bytes(std::span<const Image> parts, const ImageWriteConfig& config) {
    start_exr_threads();
    const std::vector<Imf::Header> headers = headers_of(parts, config);
    ExrMemoryOutput stream;
    if (parts.size() == 1) {
        write_pixels(Imf::OutputFile(stream, headers[0]), parts[0], config);
    } else {
        Imf::MultiPartOutputFile file(stream, headers.data(), int(headers.size()));
        for (size_t i = 0; i < parts.size(); ++i)
            write_pixels(Imf::OutputPart(file, int(i)), parts[i], config);
    }
    return stream.take_bytes();
}

} // namespace ql
