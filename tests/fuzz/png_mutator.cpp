// Mutates as libFuzzer does, then makes the check sums of a PNG right again (PNG specification,
// annex D), without which nothing behind the check would be reached.
#include <cstddef>
#include <cstdint>
#include <cstring>

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);
extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size,
                                          unsigned int seed);

namespace {

constexpr size_t kSignatureBytes = 8;
constexpr size_t kFrameBytes = 12;

uint32_t crc32(const uint8_t* data, size_t size) {
    uint32_t crc = 0xffffffffu;
    for (size_t i = 0; i < size; ++i) {
        crc ^= data[i];
        for (int bit = 0; bit < 8; ++bit)
            crc = (crc & 1) ? 0xedb88320u ^ (crc >> 1) : crc >> 1;
    }
    return ~crc;
}

uint32_t word_at(const uint8_t* data) {
    return uint32_t(data[0]) << 24 | uint32_t(data[1]) << 16 | uint32_t(data[2]) << 8 | data[3];
}

void set_word(uint8_t* data, uint32_t word) {
    for (int i = 0; i < 4; ++i)
        data[i] = uint8_t(word >> (24 - 8 * i));
}

void repair(uint8_t* data, size_t size) {
    size_t at = kSignatureBytes;
    while (at + kFrameBytes <= size) {
        const size_t length = word_at(data + at);
        if (length > size - at - kFrameBytes) return;
        set_word(data + at + 8 + length, crc32(data + at + 4, length + 4));
        at += length + kFrameBytes;
    }
}

} // namespace

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size,
                                          unsigned int seed) {
    const size_t mutated = LLVMFuzzerMutate(data, size, max_size);
    // One time in sixteen leave it wrong.
    if (seed % 16 != 0 && mutated > kSignatureBytes &&
        std::memcmp(data, "\x89PNG\r\n\x1a\n", 8) == 0)
        repair(data, mutated);
    return mutated;
}
