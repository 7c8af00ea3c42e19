#include "image/deep_image.h"

#include "base/check.h"
#include "base/error.h"
#include "image/atomic_file.h"
#include "image/exr_check.h"
#include "image/exr_stream.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineInputFile.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>

#include <algorithm>
#include <cstring>
#include <system_error>

namespace ql {

namespace {

// Bytes that one byte of deflated data can stand for at most.
constexpr uint64_t kMaxInflation = 1032;
// A row that the format's 32-bit sizes can hold.
constexpr uint64_t kMaxRowBytes = (uint64_t{1} << 31) - 1;

std::string shown_name(const std::string& path, const char* standard) {
    return path == "-" ? standard : path;
}

Imf::PixelType pixel_type(const DeepChannel& channel) {
    return channel.type == DeepChannel::Type::uint32 ? Imf::UINT : Imf::FLOAT;
}

void set_metadata(Imf::Header& header, const DeepHeader& from) {
    for (const auto& [key, value] : from.metadata) {
        if (const auto* i = std::get_if<int>(&value)) header.insert(key, Imf::IntAttribute(*i));
        if (const auto* d = std::get_if<double>(&value))
            header.insert(key, Imf::DoubleAttribute(*d));
        if (const auto* s = std::get_if<std::string>(&value))
            header.insert(key, Imf::StringAttribute(*s));
        if (const auto* v = std::get_if<Imath::V3d>(&value))
            header.insert(key, Imf::V3dAttribute(*v));
    }
}

void get_metadata(const Imf::Header& header, DeepHeader& to) {
    for (auto it = header.begin(); it != header.end(); ++it) {
        const Imf::Attribute& attribute = it.attribute();
        if (const auto* i = dynamic_cast<const Imf::IntAttribute*>(&attribute))
            to.metadata[it.name()] = i->value();
        if (const auto* d = dynamic_cast<const Imf::DoubleAttribute*>(&attribute))
            to.metadata[it.name()] = d->value();
        if (const auto* s = dynamic_cast<const Imf::StringAttribute*>(&attribute))
            to.metadata[it.name()] = s->value();
        if (const auto* v = dynamic_cast<const Imf::V3dAttribute*>(&attribute))
            to.metadata[it.name()] = v->value();
    }
}

DeepHeader header_of(const Imf::Header& header) {
    DeepHeader result;
    const Imath::Box2i window = header.dataWindow();
    const int64_t width = int64_t(window.max.x) - window.min.x + 1;
    const int64_t height = int64_t(window.max.y) - window.min.y + 1;
    constexpr int64_t kMaxSide = 1 << 30;
    if (window.min.x != 0 || window.min.y != 0 || width < 1 || height < 1 || width > kMaxSide ||
        height > kMaxSide || uint64_t(width) * uint64_t(height) > (uint64_t{1} << 31))
        throw std::runtime_error(
            fmt::format("{} x {} pixels, expected fewer than 2^31, from 0, 0", width, height));
    result.width = int(width);
    result.height = int(height);
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
        if (c.channel().type == Imf::HALF || c.channel().xSampling != 1 ||
            c.channel().ySampling != 1)
            throw std::runtime_error(
                fmt::format("channel {} is not of 32 bits in every pixel", c.name()));
        result.channels.push_back({c.name(), c.channel().type == Imf::UINT
                                                 ? DeepChannel::Type::uint32
                                                 : DeepChannel::Type::float32});
    }
    get_metadata(header, result);
    return result;
}

// The channels of one row as OpenEXR sees them: a pointer to each pixel's samples.
class RowBuffer {
  public:
    explicit RowBuffer(const DeepHeader& header)
        : m_header(header), m_words(header.channels.size()),
          m_pointers(header.channels.size(), std::vector<char*>(size_t(header.width))) {}

    DeepRow& words() { return m_words; }

    Imf::DeepFrameBuffer frame_buffer(uint32_t* counts) {
        Imf::DeepFrameBuffer buffer;
        buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts),
                                                 sizeof(uint32_t),
                                                 sizeof(uint32_t) * size_t(m_header.width)));
        // Stride 0 along y: every row uses the same pointers.
        for (size_t c = 0; c < m_words.size(); ++c)
            buffer.insert(m_header.channels[c].name,
                          Imf::DeepSlice(pixel_type(m_header.channels[c]),
                                         reinterpret_cast<char*>(m_pointers[c].data()),
                                         sizeof(char*), 0, sizeof(uint32_t)));
        return buffer;
    }

    // Makes room for a row of these sample counts.
    void resize(std::span<const uint32_t> counts) {
        uint64_t total = 0;
        for (const uint32_t count : counts)
            total += count;
        for (size_t c = 0; c < m_words.size(); ++c) {
            m_words[c].resize(total);
            auto* at = reinterpret_cast<char*>(m_words[c].data());
            for (size_t x = 0; x < counts.size(); ++x) {
                m_pointers[c][x] = at;
                at += size_t(counts[x]) * sizeof(uint32_t);
            }
        }
    }

  private:
    const DeepHeader& m_header;
    DeepRow m_words;
    std::vector<std::vector<char*>> m_pointers;
};

void check_row_sizes(const std::string& path, const DeepHeader& header,
                     std::span<const uint32_t> counts) {
    const auto width = size_t(header.width);
    for (size_t y = 0; y < size_t(header.height); ++y) {
        uint64_t samples = 0;
        for (size_t x = 0; x < width; ++x)
            samples += counts[y * width + x];
        if (samples * header.channels.size() * sizeof(uint32_t) > kMaxRowBytes)
            throw output_error("{}: row {} has {} samples, more than a deep image can hold",
                               shown_name(path, "standard output"), y, samples);
    }
}

void decode(std::span<const std::byte> bytes, DeepReader& reader) {
    ExrMemoryInput stream(bytes);
    Imf::DeepScanLineInputFile file(stream);
    const DeepHeader header = header_of(file.header());
    const uint64_t most = reader.on_header(header);

    // Take the counts, then bound what they ask for by what the file can hold.
    const auto width = size_t(header.width), height = size_t(header.height);
    if (width * height > bytes.size() * kMaxInflation)
        throw std::runtime_error("more pixels than its bytes can hold");
    std::vector<uint32_t> counts(width * height);
    RowBuffer row(header);
    file.setFrameBuffer(row.frame_buffer(counts.data()));
    file.readPixelSampleCounts(0, header.height - 1);
    uint64_t total = 0;
    for (const uint32_t count : counts) {
        if (count > most)
            throw std::runtime_error(
                fmt::format("a pixel of {} samples, expected at most {}", count, most));
        total += count;
    }
    if (total * sizeof(uint32_t) > bytes.size() * kMaxInflation)
        throw std::runtime_error("more samples than its bytes can hold");
    reader.on_sample_counts(counts, total);
    for (size_t y = 0; y < height; ++y) {
        row.resize(std::span(counts).subspan(y * width, width));
        file.readPixels(int(y));
        reader.on_row(int(y), row.words());
    }
}

} // namespace

void write_deep_image(const std::string& path, const DeepHeader& header,
                      std::span<const uint32_t> sample_counts,
                      const std::function<void(int y, DeepRow& row)>& fill) {
    const auto width = size_t(header.width), height = size_t(header.height);
    QL_CHECK_EQ(sample_counts.size(), width * height);
    check_row_sizes(path, header, sample_counts);
    ExrMemoryOutput stream;
    try {
        Imf::Header exr(header.width, header.height);
        exr.compression() = Imf::ZIPS_COMPRESSION;
        exr.setType(Imf::DEEPSCANLINE);
        for (const DeepChannel& channel : header.channels)
            exr.channels().insert(channel.name, Imf::Channel(pixel_type(channel)));
        set_metadata(exr, header);
        Imf::DeepScanLineOutputFile file(stream, exr);
        std::vector<uint32_t> counts(sample_counts.begin(), sample_counts.end());
        RowBuffer row(header);
        file.setFrameBuffer(row.frame_buffer(counts.data()));
        for (size_t y = 0; y < height; ++y) {
            row.resize(std::span(counts).subspan(y * width, width));
            fill(int(y), row.words());
            file.writePixels(1);
        }
    } catch (const Error&) {
        throw;
    } catch (const std::exception& e) {
        throw output_error("{}: {}", shown_name(path, "standard output"), e.what());
    }
    write_file(path, stream.bytes());
}

void read_deep_image(const std::string& path, DeepReader& reader, const DeepReadConfig& config) {
    const std::vector<std::byte> bytes = read_file(path, config.max_bytes);
    const std::string name = shown_name(path, "standard input");
    constexpr char kMagic[] = {0x76, 0x2f, 0x31, 0x01};
    if (bytes.size() < sizeof kMagic || std::memcmp(bytes.data(), kMagic, sizeof kMagic) != 0)
        throw input_error("{}: no OpenEXR file, expected a deep image", name);
    check_exr(bytes, name, {config.max_bytes, config.max_bytes});
    try {
        decode(bytes, reader);
    } catch (const Error& e) {
        throw Error(e.kind(), name + ": " + e.what());
    } catch (const std::system_error&) { // no thread to be had: not the file's fault
        throw;
    } catch (const std::bad_alloc&) {
        throw input_error("{}: damaged: it asks for more memory than there is", name);
    } catch (const std::exception& e) {
        const std::string text = e.what();
        throw input_error("{}: no usable deep image: {}", name, text.substr(0, text.find('\n')));
    }
}

} // namespace ql
