#include "image/png_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>

namespace ql {

namespace {

constexpr size_t kSignatureSize = 8;
constexpr size_t kChunkOverhead = 12; // length, type, checksum

// CRC-32 of ISO 3309, bit-reversed polynomial (annex D of the specification).
constexpr std::array<uint32_t, 256> crc_table() {
    std::array<uint32_t, 256> table = {};
    for (uint32_t i = 0; i < 256; ++i) {
        uint32_t c = i;
        for (int bit = 0; bit < 8; ++bit)
            c = c & 1 ? 0xedb88320u ^ (c >> 1) : c >> 1;
        table[i] = c;
    }
    return table;
}

uint32_t crc32(std::span<const std::byte> bytes) {
    static constexpr std::array<uint32_t, 256> kTable = crc_table();
    uint32_t c = 0xffffffffu;
    for (const std::byte byte : bytes)
        c = kTable[(c ^ uint32_t(byte)) & 0xff] ^ (c >> 8);
    return ~c;
}

uint32_t big_endian(std::span<const std::byte> bytes) {
    return uint32_t(bytes[0]) << 24 | uint32_t(bytes[1]) << 16 | uint32_t(bytes[2]) << 8 |
           uint32_t(bytes[3]);
}

} // namespace

std::string png_damage(std::span<const std::byte> bytes) {
    if (bytes.size() < kSignatureSize) return "truncated";
    bytes = bytes.subspan(kSignatureSize);
    for (bool first = true;; first = false) {
        if (bytes.size() < kChunkOverhead) return "truncated";
        const size_t length = big_endian(bytes);
        const auto type_bytes = bytes.subspan(4, 4);
        const std::string type(reinterpret_cast<const char*>(type_bytes.data()), 4);
        if (!std::all_of(type.begin(), type.end(), [](unsigned char c) { return std::isalpha(c); }))
            return "a chunk without a name";
        if (length > bytes.size() - kChunkOverhead) return "truncated";
        if (crc32(bytes.subspan(4, 4 + length)) != big_endian(bytes.subspan(8 + length)))
            return fmt::format("damaged ({} has a wrong checksum)", type);
        if (first != (type == "IHDR")) return "no IHDR at the start";
        if (type == "IEND") return "";
        bytes = bytes.subspan(kChunkOverhead + length);
    }
}

} // namespace ql
