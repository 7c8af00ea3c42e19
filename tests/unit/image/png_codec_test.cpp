#include "base/error.h"
#include "image/atomic_file.h"
#include "image/image_file.h"
#include "image/picture_decode.h"
#include "image/png_codec.h"
#include "unit/scratch_folder.h"

#include <gtest/gtest.h>

#include <png.h>

#include <cmath>

namespace ql {
namespace {

// A PNG as other programs write them. Samples are as in the file: of few bits, or palette entries.
struct Foreign {
    int colour_type = PNG_COLOR_TYPE_GRAY;
    int bits = 8;
    int interlace = PNG_INTERLACE_NONE;
    std::vector<png_color> palette = {};
    std::vector<png_byte> palette_alpha = {};
    const png_color_16* transparent = nullptr;
};

constexpr size_t kWidth = 13, kHeight = 11;

size_t channels_in_file(const Foreign& foreign) {
    const bool colour = foreign.colour_type == PNG_COLOR_TYPE_RGB ||
                        foreign.colour_type == PNG_COLOR_TYPE_RGB_ALPHA;
    return (colour ? 3 : 1) + (foreign.colour_type & PNG_COLOR_MASK_ALPHA ? 1 : 0);
}

unsigned sample(const Foreign& foreign, size_t x, size_t y, size_t c) {
    const unsigned most =
        foreign.palette.empty() ? (1u << foreign.bits) - 1 : unsigned(foreign.palette.size()) - 1;
    return unsigned(x * 7919 + y * 104729 + c * 1299709) % (most + 1);
}

std::vector<std::byte> foreign_png(const Foreign& foreign) {
    // libpng packs bytes to few bits and takes 16 bits with the high byte first.
    const size_t channels = channels_in_file(foreign), bytes = foreign.bits == 16 ? 2 : 1;
    std::vector<png_byte> samples;
    for (size_t y = 0; y < kHeight; ++y)
        for (size_t x = 0; x < kWidth; ++x)
            for (size_t c = 0; c < channels; ++c) {
                const unsigned value = sample(foreign, x, y, c);
                if (bytes == 2) samples.push_back(png_byte(value >> 8));
                samples.push_back(png_byte(value & 255));
            }
    std::vector<png_bytep> rows;
    for (size_t y = 0; y < kHeight; ++y)
        rows.push_back(&samples[y * kWidth * channels * bytes]);
    std::vector<std::byte> file;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(
        png, &file,
        [](png_structp p, png_bytep data, size_t size) {
            auto* to = static_cast<std::vector<std::byte>*>(png_get_io_ptr(p));
            const auto* from = reinterpret_cast<const std::byte*>(data);
            to->insert(to->end(), from, from + size);
        },
        [](png_structp) {});
    png_set_IHDR(png, info, kWidth, kHeight, foreign.bits, foreign.colour_type, foreign.interlace,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (!foreign.palette.empty())
        png_set_PLTE(png, info, foreign.palette.data(), int(foreign.palette.size()));
    if (!foreign.palette_alpha.empty())
        png_set_tRNS(png, info, foreign.palette_alpha.data(), int(foreign.palette_alpha.size()),
                     nullptr);
    if (foreign.transparent) png_set_tRNS(png, info, nullptr, 0, foreign.transparent);
    png_write_info(png, info);
    png_set_packing(png);
    png_write_image(png, rows.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return file;
}

Image image_of(const Foreign& foreign) {
    const ScratchFolder folder;
    write_file(folder / "a.png", foreign_png(foreign));
    return read_image(folder / "a.png");
}

// Every sample of plane c is what `expected` says, in levels of the file.
template<class F>
void expect_plane(const Image& image, size_t c, double top, const F& expected) {
    for (size_t y = 0; y < kHeight; ++y)
        for (size_t x = 0; x < kWidth; ++x)
            ASSERT_NEAR(double(image.planes.at(c).pixels(int(x), int(y))) * top, expected(x, y),
                        0.01)
                << image.planes[c].name << " at " << x << ", " << y;
}

TEST(PngCodec, EveryDepthOfGreyAndColourStraightAndInterlaced) {
    for (const int interlace : {PNG_INTERLACE_NONE, PNG_INTERLACE_ADAM7})
        for (const int type : {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                               PNG_COLOR_TYPE_RGB_ALPHA})
            for (const int bits : {1, 2, 4, 8, 16}) {
                if (bits < 8 && type != PNG_COLOR_TYPE_GRAY) continue;
                SCOPED_TRACE(fmt::format("type {}, {} bits, interlace {}", type, bits, interlace));
                const Foreign foreign = {type, bits, interlace};
                const Image image = image_of(foreign);
                ASSERT_EQ(image.planes.size(), channels_in_file(foreign));
                EXPECT_EQ(image.source_bits, bits == 16 ? 16 : 8);
                const std::string names[] = {"Y", "Y, A", "R, G, B", "R, G, B, A"};
                EXPECT_EQ(image.channel_names(), names[image.planes.size() - 1]);
                for (size_t c = 0; c < image.planes.size(); ++c)
                    expect_plane(image, c, (1 << bits) - 1, [&](size_t x, size_t y) {
                        return double(sample(foreign, x, y, c));
                    });
            }
}

TEST(PngCodec, PalettesBecomeColours) {
    for (const int interlace : {PNG_INTERLACE_NONE, PNG_INTERLACE_ADAM7})
        for (const int bits : {1, 2, 4, 8}) {
            SCOPED_TRACE(fmt::format("{} bits, interlace {}", bits, interlace));
            Foreign foreign = {PNG_COLOR_TYPE_PALETTE, bits, interlace};
            for (int i = 0; i < std::min(1 << bits, 200); ++i)
                foreign.palette.push_back({png_byte(i * 31), png_byte(i * 57), png_byte(255 - i)});
            EXPECT_EQ(image_of(foreign).planes.size(), 3u);
            foreign.palette_alpha = {0, 128}; // those beyond are opaque
            const Image image = image_of(foreign);
            ASSERT_EQ(image.channel_names(), "R, G, B, A");
            const auto entry = [&](size_t x, size_t y) { return sample(foreign, x, y, 0); };
            expect_plane(image, 0, 255, [&](size_t x, size_t y) {
                return double(foreign.palette[entry(x, y)].red);
            });
            expect_plane(image, 2, 255, [&](size_t x, size_t y) {
                return double(foreign.palette[entry(x, y)].blue);
            });
            expect_plane(image, 3, 255, [&](size_t x, size_t y) {
                return entry(x, y) == 0 ? 0.0 : entry(x, y) == 1 ? 128.0 : 255.0;
            });
        }
}

TEST(PngCodec, ATransparentColourBecomesAlpha) {
    for (const int bits : {2, 8, 16}) {
        SCOPED_TRACE(bits);
        png_color_16 colour = {};
        colour.gray = 3;
        Foreign foreign = {PNG_COLOR_TYPE_GRAY, bits};
        foreign.transparent = &colour;
        const Image image = image_of(foreign);
        ASSERT_EQ(image.channel_names(), "Y, A");
        expect_plane(image, 0, (1 << bits) - 1,
                     [&](size_t x, size_t y) { return double(sample(foreign, x, y, 0)); });
        expect_plane(image, 1, 1,
                     [&](size_t x, size_t y) { return sample(foreign, x, y, 0) == 3 ? 0.0 : 1.0; });
    }
}

TEST(PngCodec, PicturesOfSixteenBitsAreRoundedToEight) {
    const Foreign foreign = {PNG_COLOR_TYPE_RGB, 16};
    const Picture picture = decode_picture(foreign_png(foreign), "picture");
    for (size_t y = 0; y < kHeight; ++y)
        for (size_t x = 0; x < kWidth; ++x)
            for (size_t c = 0; c < 3; ++c)
                ASSERT_EQ(picture.rgba[(y * kWidth + x) * 4 + c],
                          std::lround(sample(foreign, x, y, c) / 257.0));
}

TEST(PngCodec, TextGoesThroughAndBecomesTheImagesMetadata) {
    const ScratchFolder folder;
    Image image(2, 1);
    image.name = "motion_0_0";
    image.plane("Y");
    image.metadata["ImageDescription"] = std::string("a mask");
    image.metadata["ql:seed"] = std::string("7");
    image.metadata["ql:step"] = 3; // no text, and left out
    write_image(folder / "a.png", image);
    const auto bytes = read_file(folder / "a.png");
    const PngText expected = {{"Software", "quietlight"},
                              {"oiio:subimagename", "motion_0_0"},
                              {"Description", "a mask"},
                              {"ql:seed", "7"}};
    EXPECT_EQ(PngReader(bytes, "a.png").header().text, expected);
    const Image back = read_image(folder / "a.png");
    EXPECT_EQ(back.name, "motion_0_0");
    EXPECT_EQ(back.metadata, (Metadata{{"Software", std::string("quietlight")},
                                       {"ImageDescription", std::string("a mask")},
                                       {"ql:seed", std::string("7")}}));
}

TEST(PngCodec, DamagedSamplesAreErrors) {
    // A check sum that fits, and no zlib stream in it.
    const std::vector<std::byte> whole = foreign_png({PNG_COLOR_TYPE_RGB, 8});
    std::vector<std::byte> bytes = whole;
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    bytes[text.find("IDAT") + 4] = std::byte(0xff);
    try {
        PngReader reader(bytes, "a.png");
        reader.samples8();
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_TRUE(std::string(error.what()).starts_with("a.png: ")) << error.what();
    }
}

} // namespace
} // namespace ql
