#include "image/deep_image.h"

#include "base/check.h"
#include "base/error.h"
#include "base/huge_vector.h"
#include "base/one_line.h"
#include "image/atomic_file.h"
#include "image/exr_check.h"
#include "image/exr_stream.h"
#include "image/exr_threads.h"

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

// Samples of all channels that are unpacked at a time, unless a row has more.
constexpr uint64_t kStripSamples = uint64_t{1} << 19;
constexpr size_t kStripRows = 256;

// The channels of a few rows as OpenEXR sees them: a pointer to each pixel's samples.
class StripBuffer {
  public:
    // counts: of the whole image; must outlive it.
    StripBuffer(const DeepHeader& header, std::vector<uint32_t>& counts)
        : m_header(header), m_counts(counts), m_words(header.channels.size()),
          m_pointers(header.channels.size()) {}

    // Rows from `begin` on that make a strip; gives them room. Returns the row after the last.
    size_t start(size_t begin) {
        const auto width = size_t(m_header.width), height = size_t(m_header.height);
        m_begin = begin;
        m_first.assign(1, 0);
        size_t end = begin;
        for (; end < std::min(height, begin + kStripRows); ++end) {
            uint64_t total = m_first.back();
            for (const uint32_t count : row_counts(end))
                total += count;
            if (end > begin && total * m_words.size() > kStripSamples) break;
            m_first.push_back(total);
        }
        for (size_t c = 0; c < m_words.size(); ++c) {
            m_words[c].resize(m_first.back());
            m_pointers[c].resize((end - begin) * width);
            auto* at = reinterpret_cast<char*>(m_words[c].data());
            for (size_t i = 0; i < m_pointers[c].size(); ++i) {
                m_pointers[c][i] = at;
                at += size_t(m_counts[begin * width + i]) * sizeof(uint32_t);
            }
        }
        return end;
    }

    DeepRow row(size_t y) {
        const size_t first = m_first[y - m_begin], end = m_first[y - m_begin + 1];
        DeepRow row;
        for (HugeVector<uint32_t>& words : m_words)
            row.push_back(std::span(words).subspan(first, end - first));
        return row;
    }

    Imf::DeepFrameBuffer frame_buffer() {
        const auto width = size_t(m_header.width);
        Imf::DeepFrameBuffer buffer;
        buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT,
                                                 reinterpret_cast<char*>(m_counts.data()),
                                                 sizeof(uint32_t), sizeof(uint32_t) * width));
        // OpenEXR counts from row 0 of the image, which need not be in memory.
        for (size_t c = 0; c < m_words.size(); ++c) {
            const auto base =
                reinterpret_cast<uintptr_t>(m_pointers[c].data()) - m_begin * width * sizeof(char*);
            buffer.insert(m_header.channels[c].name,
                          Imf::DeepSlice(pixel_type(m_header.channels[c]),
                                         reinterpret_cast<char*>(base), sizeof(char*),
                                         sizeof(char*) * width, sizeof(uint32_t)));
        }
        return buffer;
    }

  private:
    std::span<const uint32_t> row_counts(size_t y) const {
        const auto width = size_t(m_header.width);
        return std::span(m_counts).subspan(y * width, width);
    }

    const DeepHeader& m_header;
    std::vector<uint32_t>& m_counts;
    size_t m_begin = 0;
    std::vector<uint64_t> m_first; // sample of each row of the strip
    std::vector<HugeVector<uint32_t>> m_words;
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
                               output_name(path), y, samples);
    }
}

void decode(std::span<const std::byte> bytes, DeepReader& reader) {
    ExrMemoryInput stream(bytes);
    Imf::DeepScanLineInputFile file(stream);
    const DeepHeader header = header_of(file.header());
    const uint64_t most = reader.on_header(header);

    // Take the counts, then bound what they ask for by what the file can hold.
    const auto width = size_t(header.width), height = size_t(header.height);
    std::vector<uint32_t> counts(width * height);
    StripBuffer strip(header, counts);
    file.setFrameBuffer(strip.frame_buffer());
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
    for (size_t begin = 0, end = 0; begin < height; begin = end) {
        end = strip.start(begin);
        file.setFrameBuffer(strip.frame_buffer());
        file.readPixelSampleCounts(int(begin), int(end) - 1); // forgotten with the last buffer
        file.readPixels(int(begin), int(end) - 1);
        for (size_t y = begin; y < end; ++y)
            reader.on_row(int(y), strip.row(y));
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
    start_exr_threads();
    try {
        Imf::Header exr(header.width, header.height);
        exr.compression() = Imf::ZIPS_COMPRESSION;
        exr.setType(Imf::DEEPSCANLINE);
        for (const DeepChannel& channel : header.channels)
            exr.channels().insert(channel.name, Imf::Channel(pixel_type(channel)));
        set_metadata(exr, header);
        Imf::DeepScanLineOutputFile file(stream, exr);
        std::vector<uint32_t> counts(sample_counts.begin(), sample_counts.end());
        StripBuffer strip(header, counts);
        for (size_t begin = 0, end = 0; begin < height; begin = end) {
            end = strip.start(begin);
            for (size_t y = begin; y < end; ++y) {
                DeepRow row = strip.row(y);
                fill(int(y), row);
            }
            file.setFrameBuffer(strip.frame_buffer());
            file.writePixels(int(end - begin));
        }
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::system_error&) { // no thread to be had
        throw;
    } catch (const std::exception& e) {
        throw output_error("{}: {}", output_name(path), e.what());
    }
    write_file(path, stream.bytes());
}

void read_deep_image(const std::string& path, DeepReader& reader, const DeepReadConfig& config) {
    const std::vector<std::byte> bytes = read_file(path, config.max_bytes);
    const std::string name = input_name(path);
    constexpr char kMagic[] = {0x76, 0x2f, 0x31, 0x01};
    if (bytes.size() < sizeof kMagic || std::memcmp(bytes.data(), kMagic, sizeof kMagic) != 0)
        throw input_error("{}: no OpenEXR file, expected a deep image", name);
    // The library takes memory for the counts of rows before it reads any.
    const uint64_t most_counts = bytes.size() * kMaxInflation / sizeof(uint32_t);
    check_exr(bytes, name, {size_t(most_counts), config.max_bytes});
    try {
        start_exr_threads();
        decode(bytes, reader);
    } catch (const Error& e) {
        throw Error(e.kind(), name + ": " + e.what());
    } catch (const std::system_error&) { // no thread to be had: not the file's fault
        throw;
    } catch (const std::bad_alloc&) { // what damaged files may ask for is bounded by their size
        throw;
    } catch (const std::exception& e) {
        throw input_error("{}: no usable deep image: {}", name, first_line(e.what()));
    }
}

} // namespace ql
