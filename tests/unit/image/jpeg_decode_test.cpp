#include "base/error.h"
#include "image/jpeg_decode.h"
#include "image/picture_decode.h"

#include <gtest/gtest.h>

#include <cstdio> // jpeglib.h does not include what it needs

#include <jpeglib.h>
#include <webp/encode.h>

#include <cstdlib>

namespace ql {
namespace {

constexpr unsigned kWidth = 40, kHeight = 24;

enum class Scans { one, several };

// A JPEG of one colour, in the colour space that libjpeg chooses for that number of channels.
std::vector<std::byte> jpeg_of(const std::vector<uint8_t>& colour, Scans scans = Scans::one) {
    jpeg_compress_struct info = {};
    jpeg_error_mgr errors = {};
    info.err = jpeg_std_error(&errors);
    jpeg_create_compress(&info);
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&info, &bytes, &size);
    info.image_width = kWidth;
    info.image_height = kHeight;
    info.input_components = int(colour.size());
    info.in_color_space = colour.size() == 1   ? JCS_GRAYSCALE
                          : colour.size() == 3 ? JCS_RGB
                                               : JCS_CMYK;
    jpeg_set_defaults(&info);
    jpeg_set_quality(&info, 100, TRUE);
    if (scans == Scans::several) jpeg_simple_progression(&info);
    jpeg_start_compress(&info, TRUE);
    std::vector<uint8_t> row;
    for (unsigned x = 0; x < kWidth; ++x)
        row.insert(row.end(), colour.begin(), colour.end());
    for (unsigned y = 0; y < kHeight; ++y) {
        JSAMPROW rows = row.data();
        jpeg_write_scanlines(&info, &rows, 1);
    }
    jpeg_finish_compress(&info);
    jpeg_destroy_compress(&info);
    const auto* begin = reinterpret_cast<const std::byte*>(bytes);
    std::vector<std::byte> result(begin, begin + size);
    std::free(bytes);
    return result;
}

std::string error_of(std::span<const std::byte> bytes, const PictureDecodeConfig& config = {}) {
    try {
        decode_picture(bytes, "picture", config);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        return error.what();
    }
    return "";
}

void expect_colour(const JpegImage& image, const std::vector<int>& colour) {
    ASSERT_EQ(image.channels, int(colour.size()));
    ASSERT_EQ(image.samples.size(), kWidth * kHeight * colour.size());
    for (size_t i = 0; i < image.samples.size(); ++i)
        ASSERT_NEAR(image.samples[i], colour[i % colour.size()], 2);
}

TEST(JpegDecode, GreyAndColourInOneScanOrSeveral) {
    for (const Scans scans : {Scans::one, Scans::several}) {
        expect_colour(decode_jpeg(jpeg_of({77}, scans), "a", 1 << 20), {77});
        expect_colour(decode_jpeg(jpeg_of({200, 100, 50}, scans), "a", 1 << 20), {200, 100, 50});
    }
}

TEST(JpegDecode, InksBecomeWhatPaperReflects) {
    // Stored as 1 - ink: 200 * 128 / 255 and so on.
    expect_colour(decode_jpeg(jpeg_of({200, 100, 50, 128}), "a", 1 << 20), {100, 50, 25});
}

TEST(JpegDecode, SizesAreCheckedBeforeMemoryIsTaken) {
    EXPECT_EQ(error_of(jpeg_of({77}), {kWidth * kHeight}), "");
    EXPECT_EQ(error_of(jpeg_of({77}), {kWidth * kHeight - 1}),
              "picture: 40 x 24 pixels, more than the limit of 959");
}

TEST(JpegDecode, DamageIsAnErrorOrAPictureAndNothingWorse) {
    const std::vector<std::byte> whole = jpeg_of({200, 100, 50});
    for (size_t at = 3; at < whole.size(); ++at)
        for (const int value : {0, 1, 0x7f, 0xff}) {
            std::vector<std::byte> bytes = whole;
            bytes[at] = std::byte(value);
            error_of(bytes, {1 << 16});
        }
    for (size_t size = 0; size + 1 < whole.size(); ++size)
        EXPECT_NE(error_of(std::span(whole).first(size)), "") << size;
}

std::vector<std::byte> webp_of(const std::vector<uint8_t>& rgba, int width) {
    uint8_t* bytes = nullptr;
    const size_t size =
        WebPEncodeLosslessRGBA(rgba.data(), width, int(rgba.size()) / 4 / width, width * 4, &bytes);
    const auto* begin = reinterpret_cast<const std::byte*>(bytes);
    std::vector<std::byte> result(begin, begin + size);
    WebPFree(bytes);
    return result;
}

TEST(WebpDecode, SamplesAreKeptAndNotMultipliedByAlpha) {
    const std::vector<uint8_t> rgba = {200, 100, 50, 10, 1, 2, 3, 255, 9, 8, 7, 128, 0, 0, 0, 1};
    const Picture picture = decode_picture(webp_of(rgba, 2), "picture");
    EXPECT_EQ(picture.width, 2);
    EXPECT_EQ(picture.height, 2);
    EXPECT_EQ(picture.rgba, rgba);
}

TEST(WebpDecode, TruncatedAndLargePicturesAreErrors) {
    const std::vector<std::byte> whole = webp_of(std::vector<uint8_t>(64, 99), 4);
    for (size_t size = 0; size < whole.size(); ++size)
        EXPECT_NE(error_of(std::span(whole).first(size)), "") << size;
    EXPECT_EQ(error_of(whole, {15}), "picture: 4 x 4 pixels, more than the limit of 15");
}

} // namespace
} // namespace ql
