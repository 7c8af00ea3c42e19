#include "base/error.h"
#include "image/atomic_file.h"
#include "image/image_file.h"
#include "unit/scratch_folder.h"

#include <gtest/gtest.h>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatVectorAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <OpenEXR/ImfTiledOutputPart.h>
#include <OpenEXR/ImfVecAttribute.h>

#include <list>

namespace ql {
namespace {

constexpr int kWidth = 45, kHeight = 37;

// A file by another program: its data window begins elsewhere than its display window.
Imf::Header foreign_header(Imf::Compression compression) {
    Imf::Header header(Imath::Box2i({0, 0}, {99, 79}),
                       Imath::Box2i({-7, 5}, {-7 + kWidth - 1, 5 + kHeight - 1}));
    header.compression() = compression;
    return header;
}

// Smooth values that halves hold, so that even lossy compression keeps them nearly.
float value_at(int x, int y) {
    return float(x) / 64 + float(y) / 128;
}
uint32_t word_at(int x, int y) {
    return 0xfff00000u + uint32_t(x * 1000 + y);
}

// Samples of all channels of a header, which live as long as this does.
class Samples {
  public:
    explicit Samples(const Imf::Header& header) {
        for (auto it = header.channels().begin(); it != header.channels().end(); ++it)
            add(it.name(), it.channel().type, header.dataWindow());
    }
    const Imf::FrameBuffer& buffer() const { return m_buffer; }

  private:
    template<class T, class F>
    const void* made(std::list<std::vector<T>>& store, const F& f) {
        std::vector<T>& samples = store.emplace_back();
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                samples.push_back(T(f(x, y)));
        return samples.data();
    }
    void add(const char* name, Imf::PixelType type, const Imath::Box2i& window) {
        const void* first = type == Imf::HALF    ? made(m_halves, value_at)
                            : type == Imf::FLOAT ? made(m_floats, value_at)
                                                 : made(m_words, word_at);
        m_buffer.insert(name, Imf::Slice::Make(type, first, window));
    }

    std::list<std::vector<Imath::half>> m_halves;
    std::list<std::vector<float>> m_floats;
    std::list<std::vector<uint32_t>> m_words;
    Imf::FrameBuffer m_buffer;
};

void write_tiles(const std::string& path, Imf::Header header, Imf::LevelMode levels) {
    header.setTileDescription(Imf::TileDescription(16, 24, levels));
    Imf::TiledOutputFile file(path.c_str(), header);
    const Samples samples(header);
    file.setFrameBuffer(samples.buffer());
    for (int level = 0; level < file.numLevels(); ++level)
        file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
}

void write_lines(const std::string& path, const Imf::Header& header) {
    Imf::OutputFile file(path.c_str(), header);
    const Samples samples(header);
    file.setFrameBuffer(samples.buffer());
    file.writePixels(kHeight);
}

void expect_values(const Image& image, float tolerance) {
    ASSERT_EQ(image.width, kWidth);
    ASSERT_EQ(image.height, kHeight);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            for (const auto& plane : image.planes)
                ASSERT_NEAR(plane.pixels(x, y), value_at(x, y), tolerance) << plane.name;
            for (const auto& plane : image.uint_planes)
                ASSERT_EQ(plane.pixels(x, y), word_at(x, y)) << plane.name;
        }
}

std::string error_of(const std::string& path) {
    try {
        read_image_parts(path);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    return "";
}

TEST(ExrRead, EveryCompressionInLinesAndTiles) {
    const ScratchFolder folder;
    for (int c = Imf::NO_COMPRESSION; c < Imf::NUM_COMPRESSION_METHODS; ++c) {
        Imf::Header header = foreign_header(Imf::Compression(c));
        header.channels().insert("R", Imf::Channel(Imf::HALF));
        header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
        header.channels().insert("seed", Imf::Channel(Imf::UINT));
        const bool exact = c <= Imf::PIZ_COMPRESSION;
        write_lines(folder / "lines.exr", header);
        write_tiles(folder / "tiles.exr", header, Imf::ONE_LEVEL);
        write_tiles(folder / "levels.exr", header, Imf::MIPMAP_LEVELS);
        for (const char* name : {"lines.exr", "tiles.exr", "levels.exr"}) {
            SCOPED_TRACE(std::string(name) + ", compression " + std::to_string(c));
            const Image image = read_image(folder / name);
            expect_values(image, exact ? 0.0f : 0.02f);
            EXPECT_EQ(image.channel_names(), "R, Z, seed");
            EXPECT_EQ(image.source_bits, 32);
        }
    }
}

TEST(ExrRead, LinesFromBelowAndHalvesOnly) {
    const ScratchFolder folder;
    Imf::Header header = foreign_header(Imf::ZIP_COMPRESSION);
    header.lineOrder() = Imf::DECREASING_Y;
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    write_lines(folder / "a.exr", header);
    const Image image = read_image(folder / "a.exr");
    expect_values(image, 0);
    EXPECT_EQ(image.source_bits, 16);
}

TEST(ExrRead, ChannelsComeByLayerColoursFirst) {
    const ScratchFolder folder;
    Imf::Header header = foreign_header(Imf::ZIP_COMPRESSION);
    for (const char* name : {"A", "B", "G", "R", "Z", "extra", "N.X", "N.Y", "N.Z", "direct.B",
                             "direct.G", "direct.R", "v.y", "v.z"})
        header.channels().insert(name, Imf::Channel(Imf::HALF));
    write_lines(folder / "a.exr", header);
    EXPECT_EQ(read_image(folder / "a.exr").channel_names(),
              "R, G, B, A, Z, extra, N.X, N.Y, N.Z, direct.R, direct.G, direct.B, v.y, v.z");
}

TEST(ExrRead, PartsOfLinesAndTilesInOneFile) {
    const ScratchFolder folder;
    std::vector<Imf::Header> headers(2, foreign_header(Imf::ZIP_COMPRESSION));
    headers[0].setName("lines");
    headers[0].setType(Imf::SCANLINEIMAGE);
    headers[0].channels().insert("R", Imf::Channel(Imf::FLOAT));
    headers[1].setName("tiles");
    headers[1].setType(Imf::TILEDIMAGE);
    headers[1].setTileDescription(Imf::TileDescription(32, 32));
    headers[1].channels().insert("seed", Imf::Channel(Imf::UINT));
    {
        Imf::MultiPartOutputFile file((folder / "a.exr").c_str(), headers.data(), 2);
        const Samples first(headers[0]), second(headers[1]);
        Imf::OutputPart lines(file, 0);
        lines.setFrameBuffer(first.buffer());
        lines.writePixels(kHeight);
        Imf::TiledOutputPart tiles(file, 1);
        tiles.setFrameBuffer(second.buffer());
        tiles.writeTiles(0, tiles.numXTiles() - 1, 0, tiles.numYTiles() - 1);
    }
    const std::vector<Image> parts = read_image_parts(folder / "a.exr");
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_EQ(parts[0].name, "lines");
    EXPECT_EQ(parts[1].name, "tiles");
    for (const Image& part : parts)
        expect_values(part, 0);
    EXPECT_TRUE(parts[0].find("R"));
    EXPECT_FALSE(parts[1].find("R"));
}

TEST(ExrRead, AttributesOfOtherPrograms) {
    const ScratchFolder folder;
    Imf::Header header = foreign_header(Imf::ZIP_COMPRESSION);
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    header.insert("comments", Imf::StringAttribute("a view"));
    header.insert("empty", Imf::StringAttribute(""));
    header.insert("eye", Imf::V3fAttribute({1, 2, 3}));
    header.insert("list", Imf::FloatVectorAttribute({1, 2, 3, 4, 5}));
    header.insert("nothing", Imf::FloatVectorAttribute());
    header.insert("pixel", Imf::V2iAttribute({1, 2})); // a type that images do not hold
    write_lines(folder / "a.exr", header);
    const Metadata expected = {{"ImageDescription", std::string("a view")},
                               {"eye", std::vector<float>{1, 2, 3}},
                               {"list", std::vector<float>{1, 2, 3, 4, 5}}};
    const Image image = read_image(folder / "a.exr");
    EXPECT_EQ(image.metadata, expected);
    // And out again under the file's own names, however often.
    write_image(folder / "b.exr", image);
    Image again = read_image(folder / "b.exr");
    again.metadata.erase("Software");
    EXPECT_EQ(again.metadata, expected);
}

TEST(ExrRead, MetadataCannotBreakTheHeader) {
    const ScratchFolder folder;
    Image image(2, 2);
    image.plane("Y");
    for (const char* key : {"channels", "dataWindow", "compression", "type", "tiles", "name", ""})
        image.metadata[key] = std::string("text");
    for (const char* key : {"Software", "comments"})
        image.metadata[key] = 7;
    image.metadata["ImageDescription"] = std::string("text"); // "comments" in the file
    write_image(folder / "a.exr", image);
    Image back = read_image(folder / "a.exr");
    EXPECT_EQ(*back.find_metadata<std::string>("Software"), "quietlight");
    EXPECT_EQ(back.metadata.size(), 2u);
}

TEST(ExrRead, SubsampledChannelsAreRefused) {
    const ScratchFolder folder;
    Imf::Header header(8, 8);
    header.channels().insert("Y", Imf::Channel(Imf::FLOAT, 2, 2));
    const std::vector<float> samples(16);
    Imf::FrameBuffer buffer;
    buffer.insert("Y",
                  Imf::Slice::Make(Imf::FLOAT, samples.data(), header.dataWindow(), 0, 0, 2, 2));
    {
        Imf::OutputFile file((folder / "a.exr").c_str(), header);
        file.setFrameBuffer(buffer);
        file.writePixels(8);
    }
    EXPECT_NE(error_of(folder / "a.exr").find("channel Y has a sample in 2 x 2 pixels"),
              std::string::npos);
}

TEST(ExrRead, TruncatedTilesAreErrors) {
    const ScratchFolder folder;
    Imf::Header header = foreign_header(Imf::ZIP_COMPRESSION);
    header.channels().insert("R", Imf::Channel(Imf::HALF));
    write_tiles(folder / "a.exr", header, Imf::ONE_LEVEL);
    const auto bytes = read_file(folder / "a.exr");
    for (size_t i = 0; i < 32; ++i) {
        write_file(folder / "cut.exr", std::span(bytes).first(bytes.size() * i / 32));
        EXPECT_NE(error_of(folder / "cut.exr"), "") << i;
    }
}

} // namespace
} // namespace ql
