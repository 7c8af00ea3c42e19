#include "base/error.h"
#include "image/picture_decode.h"

#include <gtest/gtest.h>

#include <cstring>

namespace ql {
namespace {

using Bytes = std::vector<uint8_t>;

uint32_t crc32(const Bytes& bytes) {
    uint32_t crc = 0xffffffffu;
    for (const uint8_t byte : bytes) {
        crc ^= byte;
        for (int bit = 0; bit < 8; ++bit)
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0u);
    }
    return ~crc;
}

void append_word(Bytes& to, size_t word) {
    for (int shift = 24; shift >= 0; shift -= 8)
        to.push_back(uint8_t(word >> shift));
}

void append_chunk(Bytes& png, const char* kind, const Bytes& data) {
    append_word(png, data.size());
    Bytes checked(kind, kind + 4);
    checked.insert(checked.end(), data.begin(), data.end());
    png.insert(png.end(), checked.begin(), checked.end());
    append_word(png, crc32(checked));
}

// An 8-bit PNG of one row, stored without compression. colour_type: 0 grey, 2 RGB, 4 grey and
// alpha, 6 RGBA.
Bytes png(uint32_t width, uint8_t colour_type, const Bytes& samples) {
    Bytes header;
    append_word(header, width);
    append_word(header, 1);
    header.insert(header.end(), {8, colour_type, 0, 0, 0});
    Bytes row = {0};
    row.insert(row.end(), samples.begin(), samples.end());
    uint32_t a = 1, b = 0; // Adler-32
    for (const uint8_t byte : row) {
        a = (a + byte) % 65521;
        b = (b + a) % 65521;
    }
    const uint8_t size = uint8_t(row.size());
    Bytes data = {0x78, 1, 1, size, 0, uint8_t(~size), 0xff};
    data.insert(data.end(), row.begin(), row.end());
    append_word(data, size_t(b) << 16 | a);
    Bytes result = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    append_chunk(result, "IHDR", header);
    append_chunk(result, "IDAT", data);
    append_chunk(result, "IEND", {});
    return result;
}

Picture decoded(const Bytes& bytes, const PictureDecodeConfig& config = {}) {
    return decode_picture(std::as_bytes(std::span(bytes)), "picture", config);
}

std::string error_of(const Bytes& bytes, const PictureDecodeConfig& config = {}) {
    try {
        decoded(bytes, config);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    return "";
}

TEST(PictureDecode, AnyNumberOfChannelsBecomesRgba) {
    EXPECT_EQ(decoded(png(2, 0, {7, 9})).rgba, (Bytes{7, 7, 7, 255, 9, 9, 9, 255}));
    EXPECT_EQ(decoded(png(1, 4, {7, 9})).rgba, (Bytes{7, 7, 7, 9}));
    EXPECT_EQ(decoded(png(1, 2, {1, 2, 3})).rgba, (Bytes{1, 2, 3, 255}));
    EXPECT_EQ(decoded(png(1, 6, {200, 100, 50, 10})).rgba, (Bytes{200, 100, 50, 10}));
}

TEST(PictureDecode, ColoursBehindTransparencyAreKept) {
    EXPECT_EQ(decoded(png(1, 6, {200, 100, 50, 0})).rgba, (Bytes{200, 100, 50, 0}));
}

TEST(PictureDecode, BadPicturesAreNamedInOneLine) {
    EXPECT_EQ(error_of({}), "picture: empty, expected an image");
    EXPECT_EQ(error_of({1, 2, 3}), "picture: unknown image format, expected PNG or JPEG");
    EXPECT_EQ(error_of({0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb}),
              "picture: KTX2 images are not supported, expected PNG or JPEG");
    EXPECT_EQ(error_of(png(2, 0, {7, 9}), {1}), "picture: 2 x 1 pixels, more than the limit of 1");
}

TEST(PictureDecode, FormatsThatGltfDoesNotHaveAreNamedAndNotRead) {
    const std::pair<const char*, Bytes> formats[] = {{"GIF", {'G', 'I', 'F', '8', '9', 'a'}},
                                                     {"BMP", {'B', 'M', 0, 0}},
                                                     {"TIFF", {'I', 'I', '*', 0}},
                                                     {"TIFF", {'M', 'M', 0, '*'}},
                                                     {"DDS", {'D', 'D', 'S', ' '}}};
    for (const auto& [name, bytes] : formats)
        EXPECT_EQ(error_of(bytes), std::string("picture: ") + name +
                                       " images are not supported, expected PNG or JPEG");
}

TEST(PictureDecode, TruncatedPicturesAreErrors) {
    const Bytes whole = png(8, 6, Bytes(32, 100));
    for (size_t size = 1; size < whole.size(); ++size) {
        const std::string error =
            error_of(Bytes(whole.begin(), whole.begin() + std::ptrdiff_t(size)));
        EXPECT_TRUE(error.starts_with("picture: ")) << size;
        EXPECT_EQ(error.find('\n'), std::string::npos);
    }
}

TEST(PictureDecode, JpegWithoutItsEndIsTruncated) {
    EXPECT_EQ(error_of({0xff, 0xd8, 0xff, 0xe0, 0, 16}), "picture: truncated JPEG of 6 bytes");
}

TEST(PictureDecode, DamagedPicturesAreErrors) {
    const Bytes whole = png(8, 6, Bytes(32, 100));
    for (size_t at = 8; at < whole.size(); ++at) {
        Bytes damaged = whole;
        damaged[at] ^= 0x10;
        EXPECT_NE(error_of(damaged), "") << at;
    }
}

TEST(PictureDecode, HugeClaimsAreRefusedBeforeMemoryIsTaken) {
    EXPECT_EQ(error_of(png(2000000000, 6, {1, 2, 3, 4})),
              "picture: PNG of 2000000000 x 1 pixels, expected 1 to 1000000 each way");
    EXPECT_EQ(error_of(png(1, 5, {1})),
              "picture: PNG of colour type 5 with 8 bits, which does not exist");
}

} // namespace
} // namespace ql
