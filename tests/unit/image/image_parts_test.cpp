#include "image/image_file.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace ql {
namespace {

Image part(const std::string& name, float value) {
    Image image(3, 2);
    image.name = name;
    image.plane("dx").values() = {value, -1, 2, 3, 4, 5};
    image.plane("dy")(2, 1) = 7;
    image.uint_plane("seed")(1, 1) = 0xffffffffu;
    image.metadata["ql:step"] = std::string("49,37");
    image.metadata["ql:count"] = 3;
    return image;
}

TEST(ImageParts, ComeBackWithNamesChannelsAndMetadata) {
    const std::string path = testing::TempDir() + "image_parts_test.exr";
    const std::vector<Image> written = {part("motion_-1_0", 10), part("motion_0_0", 20)};
    write_image_parts(path, written);
    const std::vector<Image> read = read_image_parts(path);
    std::remove(path.c_str());
    ASSERT_EQ(read.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(read[i].name, written[i].name);
        for (const char* channel : {"dx", "dy"})
            EXPECT_EQ(*read[i].find(channel), *written[i].find(channel));
        EXPECT_EQ(*read[i].find_uint("seed"), *written[i].find_uint("seed"));
        EXPECT_EQ(*read[i].find_metadata<std::string>("ql:step"), "49,37");
        EXPECT_EQ(*read[i].find_metadata<int>("ql:count"), 3);
    }
}

} // namespace
} // namespace ql
