#include "image/image_file.h"

#include "base/error.h"
#include "image/atomic_file.h"
#include "unit/scratch_folder.h"

#include <gtest/gtest.h>

#include <Imath/ImathMatrix.h>
#include <Imath/half.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <random>

namespace ql {
namespace {

std::vector<float> awkward_floats() {
    return {0.0f,      -0.0f,    1.0f,    -1.5f, 0.1f,        70000.0f, 3.4028235e38f,
            1.17e-38f, 1.4e-45f, -1e-40f, 1e30f, 16777216.0f, -123.456f};
}

Image sample_image(int width, int height) {
    Image image(width, height);
    std::mt19937 random(1);
    const auto values = awkward_floats();
    for (const char* name : {"R", "G", "B", "Z", "N.X", "direct.R"})
        for (float& value : image.plane(name).values())
            value = values[random() % values.size()];
    for (uint32_t& word : image.uint_plane("seed").values())
        word = uint32_t(random());
    for (uint32_t& word : image.uint_plane("Object").values())
        word = 0x7f800000u + uint32_t(random() % 100); // infinity and NaN if read as floats
    return image;
}

void expect_equal(const Image& a, const Image& b) {
    ASSERT_EQ(a.width, b.width);
    ASSERT_EQ(a.height, b.height);
    ASSERT_EQ(a.planes.size(), b.planes.size());
    ASSERT_EQ(a.uint_planes.size(), b.uint_planes.size());
    for (const auto& plane : a.planes) {
        ASSERT_TRUE(b.find(plane.name)) << plane.name;
        EXPECT_EQ(std::memcmp(plane.pixels.values().data(), b.find(plane.name)->values().data(),
                              plane.pixels.size() * sizeof(float)),
                  0)
            << plane.name;
    }
    for (const auto& plane : a.uint_planes) {
        ASSERT_TRUE(b.find_uint(plane.name)) << plane.name;
        EXPECT_EQ(plane.pixels, *b.find_uint(plane.name)) << plane.name;
    }
}

std::string error_of(const std::string& path, const ImageReadConfig& config = {}) {
    try {
        read_image_parts(path, config);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        return error.what();
    }
    return "";
}

TEST(Image, ReferencesToPlanesStayValidWhenOthersAreAdded) {
    Image image(2, 1);
    Array2D<float>& first = image.plane("0");
    Array2D<uint32_t>& word = image.uint_plane("0");
    for (int i = 1; i < 100; ++i) {
        image.plane(std::to_string(i));
        image.uint_plane(std::to_string(i));
    }
    first[1] = 7;
    word[1] = 8;
    EXPECT_EQ((*image.find("0"))[1], 7);
    EXPECT_EQ((*image.find_uint("0"))[1], 8u);
    EXPECT_EQ(&image.plane("0"), &first);
}

TEST(ExrFile, KeepsFloatsAndWordsBitForBit) {
    const ScratchFolder folder;
    for (const auto& [width, height] : {std::pair(1, 1), {7, 1}, {1, 9}, {33, 70}}) {
        const Image image = sample_image(width, height);
        write_image(folder / "a.exr", image);
        expect_equal(image, read_image(folder / "a.exr"));
    }
}

TEST(ExrFile, KeepsFilesOfWordsOnly) {
    const ScratchFolder folder;
    Image image(5, 4);
    for (size_t i = 0; i < 20; ++i)
        image.uint_plane("seed")[i] = 0xffffffffu - uint32_t(i);
    write_image(folder / "a.exr", image);
    expect_equal(image, read_image(folder / "a.exr"));
}

TEST(ExrFile, HalfRoundsToTheNearestAndRefusesWhatDoesNotFit) {
    const ScratchFolder folder;
    Image image(4, 1);
    image.plane("Y").values() = {0.1f, 1.0f / 3.0f, 65504.0f, -1e-7f};
    ImageWriteConfig config;
    config.depth = FloatDepth::half;
    write_image(folder / "a.exr", image, config);
    const Image back = read_image(folder / "a.exr");
    EXPECT_EQ(back.source_bits, 16);
    for (size_t i = 0; i < 4; ++i)
        EXPECT_EQ((*back.find("Y"))[i], float(Imath::half(image.plane("Y")[i])));
    image.plane("Y")[2] = 70000;
    EXPECT_THROW(write_image(folder / "b.exr", image, config), Error);
    EXPECT_FALSE(std::filesystem::exists(folder / "b.exr"));
}

TEST(ExrFile, KeepsPartsWithTheirNamesAndSizes) {
    const ScratchFolder folder;
    std::vector<Image> parts;
    for (int i = 0; i < 3; ++i) {
        parts.push_back(sample_image(8 + i, 5));
        parts.back().name = "motion" + std::to_string(i);
        parts.back().metadata["ql:part"] = i;
    }
    write_image_parts(folder / "a.exr", parts);
    const std::vector<Image> back = read_image_parts(folder / "a.exr");
    ASSERT_EQ(back.size(), 3u);
    for (size_t i = 0; i < 3; ++i) {
        expect_equal(parts[i], back[i]);
        EXPECT_EQ(back[i].name, parts[i].name);
        ASSERT_TRUE(back[i].find_metadata<int>("ql:part"));
        EXPECT_EQ(*back[i].find_metadata<int>("ql:part"), int(i));
    }
    EXPECT_THROW(read_image(folder / "a.exr"), Error);
}

TEST(ExrFile, WritesNothingBesideTheFileItIsAskedFor) {
    const ScratchFolder folder;
    std::vector<Image> parts = {sample_image(4, 4), Image(4, 4)};
    parts[0].name = "color";
    parts[1].name = "mask";
    parts[1].plane("Y");
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(folder / "");
    write_image_parts("a.exr", parts);
    write_image("b.exr", parts[0]);
    std::filesystem::current_path(before);
    EXPECT_EQ(folder.file_count(), 2u);
    expect_equal(read_image_parts(folder / "a.exr").at(1), parts[1]);
}

TEST(ExrFile, KeepsMetadataUnderTheSameNames) {
    const ScratchFolder folder;
    Image image(2, 2);
    image.plane("R");
    image.metadata["ql:step"] = 48;
    image.metadata["ql:sigma"] = 1.9f;
    image.metadata["ql:mask"] = std::string("a mask, \"quoted\"");
    image.metadata["ql:energies"] = std::vector<float>{1, 2.5f, 3};
    const Imath::M44f matrix(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16);
    image.metadata["worldToCamera"] = matrix;
    image.metadata["worldToNDC"] = matrix;
    write_image(folder / "a.exr", image);
    Image back = read_image(folder / "a.exr");
    EXPECT_EQ(*back.find_metadata<std::string>("Software"), "quietlight");
    back.metadata.erase("Software");
    for (const auto& [key, value] : image.metadata) {
        ASSERT_TRUE(back.metadata.contains(key)) << key;
        EXPECT_TRUE(back.metadata[key] == value) << key;
    }
    for (const auto& [key, value] : back.metadata)
        EXPECT_TRUE(image.metadata.contains(key)) << key << " was added";
}

TEST(ExrFile, CarriesMatricesForRowVectors) {
    // A camera at (1, 2, 3) that looks along -z: the origin is at (-1, -2, -3) before it.
    const ScratchFolder folder;
    Image image(2, 2);
    image.plane("R");
    Imath::M44f camera_from_world;
    camera_from_world.setTranslation(Imath::V3f(-1, -2, -3));
    image.metadata["worldToCamera"] = camera_from_world;
    write_image(folder / "a.exr", image);
    const Image back = read_image(folder / "a.exr");
    const auto* read = back.find_metadata<Imath::M44f>("worldToCamera");
    ASSERT_TRUE(read);
    EXPECT_EQ(Imath::V3f(0) * *read, Imath::V3f(-1, -2, -3));
    EXPECT_EQ(Imath::V3f(1, 2, 3) * *read, Imath::V3f(0));
}

TEST(ExrFile, MetadataOfAFileThatIsReadAndWrittenAgainStaysTheSame) {
    const ScratchFolder folder;
    Image image = sample_image(4, 4);
    image.metadata["ql:step"] = 48;
    write_image(folder / "a.exr", image);
    write_image(folder / "b.exr", read_image(folder / "a.exr"));
    write_image(folder / "c.exr", read_image(folder / "b.exr"));
    EXPECT_EQ(read_image(folder / "a.exr").metadata, read_image(folder / "c.exr").metadata);
    EXPECT_EQ(read_file(folder / "b.exr"), read_file(folder / "c.exr"));
}

TEST(ExrFile, IsTheSameBytesForAnyThreadCount) {
    const ScratchFolder folder;
    const Image image = sample_image(300, 200);
    std::vector<std::vector<std::byte>> files;
    for (int threads : {1, 2, 1}) {
        set_image_threads(threads);
        write_image(folder / "a.exr", image);
        files.push_back(read_file(folder / "a.exr"));
    }
    EXPECT_EQ(files[0], files[1]);
    EXPECT_EQ(files[0], files[2]);
}

TEST(PngFile, KeepsEveryLevelOfLinearData) {
    const ScratchFolder folder;
    for (const auto& [encoding, top] :
         {std::pair(PngEncoding::linear8, 255), std::pair(PngEncoding::linear16, 65535)}) {
        Image image(256, (top + 1) / 256);
        for (int i = 0; i <= top; ++i)
            image.plane("Y")[size_t(i)] = float(i) / float(top);
        ImageWriteConfig config;
        config.png = encoding;
        write_image(folder / "a.png", image, config);
        const Image back = read_image(folder / "a.png");
        ASSERT_EQ(back.planes.size(), 1u);
        EXPECT_EQ(back.source_bits, top == 255 ? 8 : 16);
        for (int i = 0; i <= top; ++i)
            ASSERT_EQ(std::lround(double(back.planes[0].pixels[size_t(i)]) * top), i);
    }
}

TEST(PngFile, PicturesAreEncodedAsSrgbAfterExposure) {
    const ScratchFolder folder;
    Image image(6, 1);
    image.plane("R").values() = {0, 0.25f, 0.5f, 1, 7, -1};
    image.plane("G") = image.plane("R");
    image.plane("B") = image.plane("R");
    ImageWriteConfig config;
    config.exposure_stops = 1;
    write_image(folder / "a.png", image, config);
    const Image back = read_image(folder / "a.png");
    // IEC 61966-2-1 of 0.5 is 0.7354, 187.5 of 255
    const std::vector<float> expected = {0, 188, 255, 255, 255, 0};
    for (size_t i = 0; i < 6; ++i)
        EXPECT_NEAR(back.find("R")->values()[i] * 255, expected[i], 0.01) << i;
}

TEST(PngFile, DoesNotMultiplyByAlpha) {
    const ScratchFolder folder;
    Image image(2, 1);
    for (const char* name : {"R", "G", "B"})
        image.plane(name).values() = {0.2f, 0.8f};
    image.plane("A").values() = {0.0f, 0.4f};
    ImageWriteConfig config;
    config.png = PngEncoding::linear8;
    write_image(folder / "a.png", image, config);
    const Image back = read_image(folder / "a.png");
    EXPECT_NEAR((*back.find("R"))[0], 0.2, 1e-6);
    EXPECT_NEAR((*back.find("R"))[1], 0.8, 1e-6);
    EXPECT_NEAR((*back.find("A"))[1], 0.4, 1e-6);
}

TEST(PngFile, WritesNonFiniteSamplesAsDefinedLevels) {
    const ScratchFolder folder;
    for (const PngEncoding encoding :
         {PngEncoding::srgb8, PngEncoding::linear8, PngEncoding::linear16}) {
        Image image(3, 1);
        image.plane("Y").values() = {NAN, INFINITY, -INFINITY};
        ImageWriteConfig config;
        config.png = encoding;
        write_image(folder / "a.png", image, config);
        EXPECT_EQ(read_image(folder / "a.png").planes[0].pixels.values(),
                  (std::vector<float>{0, 1, 0}));
    }
}

TEST(PngFile, RefusesChannelsAndPartsItCannotHold) {
    const ScratchFolder folder;
    Image image(2, 2);
    for (const char* name : {"N.X", "N.Y", "N.Z"})
        image.plane(name);
    EXPECT_THROW(write_image(folder / "a.png", image), Error);
    Image words(2, 2);
    words.uint_plane("seed");
    EXPECT_THROW(write_image(folder / "a.png", words), Error);
    Image grey(2, 2);
    grey.plane("Y");
    EXPECT_THROW(write_image_parts(folder / "a.png", std::vector<Image>{grey, grey}), Error);
    EXPECT_THROW(write_image(folder / "a.jpg", grey), Error);
    EXPECT_EQ(folder.file_count(), 0u);
}

TEST(ImageFile, TheDateIsTheOneAskedFor) {
    const ScratchFolder folder;
    Image image(2, 2);
    image.plane("R");
    ImageWriteConfig config;
    config.date_time = "2001:09:09 01:46:40";
    for (const char* name : {"a.exr", "a.png"}) {
        write_image(folder / name, image);
        const auto fixed = read_file(folder / name);
        write_image(folder / name, image, config);
        EXPECT_NE(fixed, read_file(folder / name));
    }
}

TEST(ImageFile, ErrorsNameChannelAndPixelOfANonFiniteSample) {
    const ScratchFolder folder;
    for (const float bad : {NAN, INFINITY, -INFINITY}) {
        Image image(8, 8);
        image.plane("R");
        image.plane("Z")(3, 5) = bad;
        write_image(folder / "a.exr", image);
        const std::string message = error_of(folder / "a.exr");
        EXPECT_NE(message.find("channel Z"), std::string::npos) << message;
        EXPECT_NE(message.find("3,5"), std::string::npos) << message;
        ImageReadConfig keep;
        keep.non_finite = NonFinite::keep;
        expect_equal(image, read_image(folder / "a.exr", keep));
    }
}

TEST(ImageFile, TheContentDecidesAndNotTheName) {
    const ScratchFolder folder;
    const Image image = sample_image(4, 4);
    write_image(folder / "a.exr", image);
    std::filesystem::rename(folder / "a.exr", folder / "a.png");
    expect_equal(image, read_image(folder / "a.png"));
}

TEST(ImageFile, WrongFilesAreErrorsThatNameTheFile) {
    const ScratchFolder folder;
    write_file(folder / "empty", "");
    write_file(folder / "text", "hello");
    write_file(folder / "magic", std::string("\x76\x2f\x31\x01", 4));
    for (const char* name : {"empty", "text", "magic", "missing"})
        EXPECT_NE(error_of(folder / name).find(name), std::string::npos) << name;
}

// The bytes of an image with every feature: two parts, floats and words, metadata.
std::vector<std::byte> exr_bytes(const ScratchFolder& folder) {
    std::vector<Image> parts = {sample_image(20, 12), sample_image(9, 9)};
    parts[0].name = "first";
    parts[1].name = "second";
    parts[0].metadata["worldToCamera"] = Imath::M44f();
    write_image_parts(folder / "whole.exr", parts);
    return read_file(folder / "whole.exr");
}

std::vector<std::byte> png_bytes(const ScratchFolder& folder) {
    Image image(20, 12);
    for (const char* name : {"R", "G", "B", "A"})
        image.plane(name)(3, 4) = 0.5f;
    write_image(folder / "whole.png", image);
    return read_file(folder / "whole.png");
}

TEST(ImageFile, ATruncatedFileIsAnErrorWhereverItEnds) {
    const ScratchFolder folder;
    for (const std::vector<std::byte>& bytes : {exr_bytes(folder), png_bytes(folder)})
        for (size_t i = 0; i < 64; ++i) {
            write_file(folder / "cut", std::span(bytes).first(bytes.size() * i / 64));
            EXPECT_NE(error_of(folder / "cut"), "") << i << "/64 of " << bytes.size();
        }
}

TEST(ImageFile, AFlippedByteIsAnErrorOrAnImageAndNothingWorse) {
    const ScratchFolder folder;
    std::mt19937 random(7);
    ImageReadConfig config;
    config.max_pixels = 1 << 22;
    config.max_bytes = 1 << 26;
    for (const std::vector<std::byte>& bytes : {exr_bytes(folder), png_bytes(folder)})
        for (int i = 0; i < 1000; ++i) {
            auto changed = bytes;
            // Half of them in the header, where most of the meaning is
            const size_t range = i % 2 ? bytes.size() : std::min<size_t>(bytes.size(), 1200);
            changed[random() % range] = std::byte(random());
            write_file(folder / "flipped", changed);
            try {
                for (const Image& part : read_image_parts(folder / "flipped", config))
                    EXPECT_LE(part.width, 1 << 22);
            } catch (const Error& error) {
                EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
                EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
            }
        }
}

void put_box(std::vector<std::byte>& bytes, const char* attribute, std::array<int32_t, 4> box) {
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::string label = std::string(attribute) + '\0' + "box2i" + '\0';
    const size_t at = text.find(label);
    ASSERT_NE(at, std::string::npos);
    std::memcpy(&bytes[at + label.size() + 4], box.data(), sizeof(box));
}

TEST(ImageFile, AHugeClaimIsRefusedBeforeMemoryIsTaken) {
    const ScratchFolder folder;
    Image image(4, 4);
    image.plane("R");
    write_image(folder / "a.exr", image);
    for (const std::array<int32_t, 4>& box : {std::array<int32_t, 4>{0, 0, 999'999, 999'999},
                                              {0, 0, 99'999, 99'999},
                                              {-1'000'000'000, 0, 1'000'000'000, 3},
                                              {0, 0, 3, 999'999'999},
                                              {INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX},
                                              {5, 5, 0, 0},
                                              {0, 0, INT32_MAX, 0}}) {
        auto bytes = read_file(folder / "a.exr");
        put_box(bytes, "dataWindow", box);
        put_box(bytes, "displayWindow", box);
        write_file(folder / "huge.exr", bytes);
        EXPECT_NE(error_of(folder / "huge.exr"), "");
    }
}

TEST(ImageFile, TheByteLimitCountsAllPartsTogether) {
    const ScratchFolder folder;
    std::vector<Image> parts;
    for (int i = 0; i < 4; ++i) {
        parts.emplace_back(64, 64);
        parts.back().name = std::to_string(i);
        parts.back().plane("Y");
    }
    write_image_parts(folder / "a.exr", parts);
    ImageReadConfig config;
    config.max_bytes = 4 * 64 * 64 * 4; // the file is much smaller
    ASSERT_LT(read_file(folder / "a.exr").size(), config.max_bytes);
    EXPECT_EQ(error_of(folder / "a.exr", config), "");
    config.max_bytes -= 1;
    EXPECT_NE(error_of(folder / "a.exr", config), "");
}

} // namespace
} // namespace ql
