#include "base/error.h"
#include "image/exr_check.h"

#include <gtest/gtest.h>

#include <cstring>

namespace ql {
namespace {

// The header of a flat scan-line file, part by part, so that each can be wrong.
struct Header {
    std::string bytes = std::string("\x76\x2f\x31\x01\x02\0\0\0", 8);

    template<class... Numbers>
    static std::string packed(Numbers... numbers) {
        std::string result;
        const auto append = [&](auto number) {
            result.append(reinterpret_cast<const char*>(&number), sizeof number);
        };
        (append(numbers), ...);
        return result;
    }
    void add(const std::string& key, const std::string& type, const std::string& value) {
        add(key, type, value, int32_t(value.size()));
    }
    void add(const std::string& key, const std::string& type, const std::string& value,
             int32_t size) {
        bytes += key + '\0' + type + '\0' + packed(size) + value;
    }
    void add_window(int32_t x0, int32_t y0, int32_t x1, int32_t y1) {
        add("dataWindow", "box2i", packed(x0, y0, x1, y1));
    }
    void add_channel(int32_t type = 2, int32_t sampling = 1) {
        add("channels", "chlist",
            std::string("Y\0", 2) + packed(type, int32_t(0), sampling, sampling) + '\0');
    }
    void add_compression(char kind) { add("compression", "compression", std::string(1, kind)); }
    void add_tiles(uint32_t width, uint32_t height) {
        bytes[5] = 2; // tiled
        add("tiles", "tiledesc", packed(width, height) + '\0');
    }

    // What is said to the file with that many bytes after the header.
    std::string answer(size_t more = 4096) const {
        const std::string file = bytes + '\0' + std::string(more, '\0');
        try {
            check_exr(std::as_bytes(std::span(file.data(), file.size())), "x.exr", {});
            return "";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
            EXPECT_EQ(std::string(error.what()).find("x.exr: "), 0u);
            return error.what();
        }
    }
};

Header good(int32_t width = 4, int32_t height = 4) {
    Header header;
    header.add_window(0, 0, width - 1, height - 1);
    header.add_channel();
    header.add_compression(0);
    return header;
}

TEST(ExrCheck, TakesAWholeHeader) {
    EXPECT_EQ(good().answer(), "");
}

TEST(ExrCheck, RefusesEveryHeaderThatEndsEarly) {
    const std::string whole = good().bytes;
    for (size_t size = 8; size < whole.size(); ++size) {
        const auto part = std::as_bytes(std::span(whole.data(), size));
        EXPECT_THROW(check_exr(part, "x.exr", {}), Error) << size;
    }
}

TEST(ExrCheck, RefusesAttributesLargerThanTheFile) {
    for (const int32_t size : {-1, 100000, 0x7fffffff}) {
        Header header = good();
        header.add("comment", "string", "", size);
        EXPECT_NE(header.answer(), "") << size;
    }
    Header header = good();
    header.add("owner", "v2f", "123");
    EXPECT_NE(header.answer(), "");
}

TEST(ExrCheck, RefusesMorePixelsThanLimitsOrBytesAllow) {
    EXPECT_NE(good(1 << 28, 4).answer(), "");
    EXPECT_NE(good(4, 100000).answer(), ""); // a table of 100000 chunks in 4096 bytes
    EXPECT_EQ(good(4, 500).answer(), "");
    Header header;
    header.add_window(INT32_MIN, 0, INT32_MAX, 3);
    header.add_channel();
    header.add_compression(0);
    EXPECT_NE(header.answer(), "");
}

TEST(ExrCheck, RefusesAttributesThatDoNotFillTheirSize) {
    const std::string channel =
        std::string("Y\0", 2) + Header::packed(2, 0, 1, 1) + std::string(1, '\0');
    for (const auto& [type, value] : {std::pair{"chlist", channel + "x"},
                                      {"floatvector", std::string("12345")},
                                      {"preview", Header::packed(1, 1) + "12345"},
                                      {"stringvector", Header::packed(9) + "1234"},
                                      {"idmanifest", std::string("12345678")}}) {
        Header header = good();
        header.add("extra", type, value);
        EXPECT_NE(header.answer(), "") << type;
    }
}

TEST(ExrCheck, RefusesTilesOfNoSizeAndLargerThanTheImage) {
    for (const auto& [width, height, taken] : {std::tuple{0u, 4u, false},
                                               {4u, 0u, false},
                                               {64u, 64u, true},
                                               {1u << 20, 1u << 20, false}}) {
        Header header = good();
        header.add_tiles(width, height);
        EXPECT_EQ(header.answer() == "", taken) << width << " x " << height;
    }
}

TEST(ExrCheck, RefusesChannelsAndCompressionsThatDoNotExist) {
    for (const auto& [type, sampling, compression] :
         {std::tuple{3, 1, 0}, {-1, 1, 0}, {2, 0, 0}, {2, -5, 0}, {2, 1, 10}, {2, 1, 127}}) {
        Header header;
        header.add_window(0, 0, 3, 3);
        header.add_channel(type, sampling);
        header.add_compression(char(compression));
        EXPECT_NE(header.answer(), "") << type << ' ' << sampling << ' ' << compression;
    }
}

TEST(ExrCheck, TakesLowImagesInCompressionsOfManyLines) {
    Header header;
    header.add_window(0, 0, 19999, 9);
    header.add_channel();
    header.add_compression(9); // 256 lines a chunk
    EXPECT_EQ(header.answer(), "");
    Header wide;
    wide.add_window(0, 0, (1 << 22) - 1, 0);
    wide.add_channel();
    wide.add_compression(9);
    EXPECT_NE(wide.answer().find("chunks of"), std::string::npos) << wide.answer();
}

} // namespace
} // namespace ql
