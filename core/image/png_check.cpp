#include "image/png_check.h"

#include "base/error.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace ql {

namespace {

constexpr size_t kSignatureBytes = 8;
constexpr size_t kFrameBytes = 12; // length, kind and check sum around the data of a chunk

struct Chunk {
    std::string_view kind;
    std::span<const std::byte> whole;
};

uint32_t word_at(std::span<const std::byte> bytes, size_t offset) {
    uint32_t word = 0;
    for (size_t i = 0; i < 4; ++i)
        word = word << 8 | uint32_t(bytes[offset + i]);
    return word;
}

// CRC-32 of ISO 3309, a byte at a time by table (PNG specification, annex D).
std::array<uint32_t, 256> crc_table() {
    std::array<uint32_t, 256> table = {};
    for (uint32_t n = 0; n < 256; ++n) {
        uint32_t c = n;
        for (int bit = 0; bit < 8; ++bit)
            c = (c & 1) ? 0xedb88320u ^ (c >> 1) : c >> 1;
        table[n] = c;
    }
    return table;
}

uint32_t crc32(std::span<const std::byte> bytes) {
    static const std::array<uint32_t, 256> kTable = crc_table();
    uint32_t crc = 0xffffffffu;
    for (const std::byte byte : bytes)
        crc = kTable[(crc ^ uint32_t(byte)) & 0xff] ^ (crc >> 8);
    return ~crc;
}

// Width, height, bit depth and colour type (PNG specification, section 11.2.2).
void check_header(std::span<const std::byte> header, const std::string& name) {
    constexpr uint32_t kMaxSide = 1000000; // libpng's limit
    const uint32_t width = word_at(header, 0);
    const uint32_t height = word_at(header, 4);
    if (width == 0 || height == 0 || width > kMaxSide || height > kMaxSide)
        throw input_error("{}: PNG of {} x {} pixels, expected 1 to {} each way", name, width,
                          height, kMaxSide);
    const int bits = int(header[8]);
    const int colour_type = int(header[9]);
    const bool few_bits = bits == 1 || bits == 2 || bits == 4;
    const bool known = colour_type == 0   ? few_bits || bits == 8 || bits == 16
                       : colour_type == 3 ? few_bits || bits == 8
                       : colour_type == 2 || colour_type == 4 || colour_type == 6
                           ? bits == 8 || bits == 16
                           : false;
    if (!known || header[10] != std::byte(0) || header[11] != std::byte(0) ||
        header[12] > std::byte(1))
        throw input_error("{}: PNG of colour type {} with {} bits, which does not exist", name,
                          colour_type, bits);
}

std::vector<Chunk> checked_chunks(std::span<const std::byte> bytes, const std::string& name) {
    std::vector<Chunk> chunks;
    size_t at = kSignatureBytes;
    while (chunks.empty() || chunks.back().kind != "IEND") {
        const size_t left = bytes.size() < at ? 0 : bytes.size() - at;
        const size_t length = left < kFrameBytes ? 0 : word_at(bytes, at);
        if (left < kFrameBytes || length > left - kFrameBytes)
            throw input_error("{}: truncated PNG of {} bytes", name, bytes.size());
        const auto whole = bytes.subspan(at, length + kFrameBytes);
        const auto* kind = reinterpret_cast<const char*>(&whole[4]);
        chunks.push_back({std::string_view(kind, 4), whole});
        if (crc32(whole.subspan(4, length + 4)) != word_at(whole, length + 8))
            throw input_error("{}: damaged PNG, wrong check sum of the chunk at byte {}", name, at);
        at += whole.size();
    }
    if (chunks.front().kind != "IHDR" || chunks.front().whole.size() != 13 + kFrameBytes)
        throw input_error("{}: PNG without header", name);
    check_header(chunks.front().whole.subspan(8, 13), name);
    return chunks;
}

} // namespace

void check_png(std::span<const std::byte> bytes, const std::string& name) {
    checked_chunks(bytes, name);
}

std::vector<std::byte> bare_png(std::span<const std::byte> bytes, const std::string& name) {
    constexpr std::string_view kPixelChunks[] = {"IHDR", "PLTE", "tRNS", "IDAT", "IEND"};
    std::vector<std::byte> bare(bytes.begin(),
                                bytes.begin() + ptrdiff_t(std::min(kSignatureBytes, bytes.size())));
    for (const Chunk& chunk : checked_chunks(bytes, name))
        if (std::find(std::begin(kPixelChunks), std::end(kPixelChunks), chunk.kind) !=
            std::end(kPixelChunks))
            bare.insert(bare.end(), chunk.whole.begin(), chunk.whole.end());
    return bare;
}

} // namespace ql
