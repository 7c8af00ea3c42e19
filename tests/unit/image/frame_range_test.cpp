#include "image/frame_range.h"

#include "base/error.h"

#include <gtest/gtest.h>

namespace ql {
namespace {

TEST(FrameRange, TakesSingleFramesRangesAndSteps) {
    EXPECT_EQ(parse_frame_range("7"), (std::vector{7}));
    EXPECT_EQ(parse_frame_range("1-4"), (std::vector{1, 2, 3, 4}));
    EXPECT_EQ(parse_frame_range("1-10x4"), (std::vector{1, 5, 9}));
    EXPECT_EQ(parse_frame_range("3,1-2,9-9"), (std::vector{3, 1, 2, 9}));
    EXPECT_EQ(parse_frame_range("999999999-999999999x999999999"), (std::vector{999999999}));
}

TEST(FrameRange, RefusesEverythingElse) {
    for (const char* text : {"", "-", "a", "1-", "-3", "4-1", "1-4x0", "1-4x", "1,,2", "1,", ",1",
                             "1 - 4", "1.5", "0-999999999", "99999999999", "1-4x-1"})
        EXPECT_THROW(parse_frame_range(text), Error) << text;
}

TEST(NumberedPath, PutsTheFrameInWithItsZeros) {
    EXPECT_EQ(numbered_path("out.%04d.exr", 12), "out.0012.exr");
    EXPECT_EQ(numbered_path("out.%04d.exr", 123456), "out.123456.exr");
    EXPECT_EQ(numbered_path("%d.exr", 12), "12.exr");
    EXPECT_EQ(numbered_path("out.exr", 12), "out.exr");
    EXPECT_TRUE(is_numbered("a%02db"));
    EXPECT_FALSE(is_numbered("ab"));
}

TEST(NumberedPath, RefusesOtherConversions) {
    EXPECT_THROW(numbered_path("a%3d_%04d", 1), Error);
    for (const char* pattern : {"%s", "%", "%4d", "%04x", "%00d", "%d%d", "%n", "100%", "%d 100%"})
        EXPECT_THROW(numbered_path(pattern, 1), Error) << pattern;
}

} // namespace
} // namespace ql
