#include "image/exr_parts.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFloatVectorAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <Imath/half.h>

#include <algorithm>
#include <cstring>
#include <list>
#include <set>

namespace ql {

namespace {

class MemoryStream : public Imf::OStream {
  public:
    MemoryStream() : Imf::OStream("memory") {}
    void write(const char bytes[], int count) override {
        m_bytes.resize(std::max(m_bytes.size(), m_position + size_t(count)));
        std::memcpy(m_bytes.data() + m_position, bytes, size_t(count));
        m_position += size_t(count);
    }
    uint64_t tellp() override { return m_position; }
    void seekp(uint64_t position) override { m_position = size_t(position); }
    std::vector<char> take() { return std::move(m_bytes); }

  private:
    std::vector<char> m_bytes;
    size_t m_position = 0;
};

bool holds_halves(const Image& image, const ImageWriteConfig& config) {
    return config.depth == FloatDepth::half && image.uint_planes.empty();
}

Imf::Header part_header(const Image& image, const ImageWriteConfig& config) {
    Imf::Header header(image.width, image.height);
    header.setName(image.name);
    header.setType(Imf::SCANLINEIMAGE);
    header.compression() = Imf::ZIP_COMPRESSION;
    header.insert("Software", Imf::StringAttribute(config.software));
    header.insert("DateTime", Imf::StringAttribute(config.date_time));
    if (image.find("R")) Imf::addChromaticities(header, Imf::Chromaticities());
    const bool halves = holds_halves(image, config);
    for (const auto& plane : image.planes)
        header.channels().insert(plane.name, Imf::Channel(halves ? Imf::HALF : Imf::FLOAT));
    for (const auto& plane : image.uint_planes)
        header.channels().insert(plane.name, Imf::Channel(Imf::UINT));
    for (const auto& [key, value] : image.metadata) {
        if (key == "Software" || key == "DateTime") continue;
        if (const auto* i = std::get_if<int>(&value)) header.insert(key, Imf::IntAttribute(*i));
        if (const auto* f = std::get_if<float>(&value)) header.insert(key, Imf::FloatAttribute(*f));
        if (const auto* s = std::get_if<std::string>(&value))
            header.insert(key, Imf::StringAttribute(*s));
        if (const auto* m = std::get_if<Imath::M44f>(&value))
            header.insert(key, Imf::M44fAttribute(*m));
        if (const auto* v = std::get_if<std::vector<float>>(&value))
            header.insert(key, Imf::FloatVectorAttribute(*v));
    }
    return header;
}

template<class T>
Imf::Slice slice(Imf::PixelType type, const Array2D<T>& pixels) {
    // The library reads from here, though the type of the pointer allows more.
    char* base = reinterpret_cast<char*>(const_cast<T*>(pixels.values().data()));
    return {type, base, sizeof(T), sizeof(T) * size_t(pixels.width())};
}

void write_part(Imf::MultiPartOutputFile& file, int number, const Image& image,
                const ImageWriteConfig& config) {
    Imf::FrameBuffer buffer;
    std::list<Array2D<Imath::half>> halves;
    for (const auto& plane : image.planes) {
        if (!holds_halves(image, config)) {
            buffer.insert(plane.name, slice(Imf::FLOAT, plane.pixels));
            continue;
        }
        Array2D<Imath::half>& half = halves.emplace_back(image.width, image.height);
        std::copy(plane.pixels.values().begin(), plane.pixels.values().end(),
                  half.values().begin());
        buffer.insert(plane.name, slice(Imf::HALF, half));
    }
    for (const auto& plane : image.uint_planes)
        buffer.insert(plane.name, slice(Imf::UINT, plane.pixels));
    Imf::OutputPart part(file, number);
    part.setFrameBuffer(buffer);
    part.writePixels(image.height);
}

} // namespace

std::vector<char> exr_parts(std::span<const Image> parts, const ImageWriteConfig& config) {
    std::vector<Imf::Header> headers;
    std::set<std::string> names;
    for (const Image& part : parts) {
        QL_CHECK(!part.name.empty() && names.insert(part.name).second);
        headers.push_back(part_header(part, config));
    }
    MemoryStream stream;
    try {
        Imf::MultiPartOutputFile file(stream, headers.data(), int(headers.size()));
        for (size_t i = 0; i < parts.size(); ++i)
            write_part(file, int(i), parts[i], config);
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        throw output_error("OpenEXR: {}", error.what());
    }
    return stream.take();
}

} // namespace ql
