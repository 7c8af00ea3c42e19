#include "base/array2d.h"
#include "base/error.h"
#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>

namespace ql {
namespace {

TEST(Array2D, IsRowMajorWithXToTheRight) {
    Array2D<int> a(3, 2);
    std::iota(a.values().begin(), a.values().end(), 0);
    EXPECT_EQ(a(2, 0), 2);
    EXPECT_EQ(a(0, 1), 3);
    EXPECT_EQ(a.row(1)[2], 5);
    EXPECT_EQ(a.size(), 6u);
}

TEST(Array2D, RefusesValuesThatDoNotFillIt) {
    EXPECT_THROW(Array2D<int>(2, 2, std::vector<int>(3)), Error);
}

TEST(Wrap, StaysInsideForAnySign) {
    for (int n : {1, 2, 7})
        for (int i = -30; i <= 30; ++i) {
            EXPECT_GE(wrap(i, n), 0);
            EXPECT_LT(wrap(i, n), n);
            EXPECT_EQ((wrap(i, n) - i) % n, 0);
        }
}

TEST(Check, NamesBothValuesAndIsAnInternalError) {
    try {
        QL_CHECK_EQ(1 + 1, 3);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::internal);
        EXPECT_NE(std::string(error.what()).find("2 against 3"), std::string::npos) << error.what();
    }
    EXPECT_THROW(QL_CHECK(1 > 2), Error);
    EXPECT_NO_THROW(QL_CHECK(2 > 1));
}

TEST(Error, KindsAreTheDocumentedExitStatuses) {
    EXPECT_EQ(int(usage_error("x").kind()), 2);
    EXPECT_EQ(int(input_error("{}: {}", "file", 1).kind()), 3);
    EXPECT_EQ(int(output_error("x").kind()), 4);
    EXPECT_EQ(int(ErrorKind::internal), 5);
    EXPECT_STREQ(input_error("{}: {}", "file", 1).what(), "file: 1");
}

TEST(Error, MessagesAreOneLineThatNoTerminalObeys) {
    EXPECT_STREQ(input_error("'{}'", "a\nb\t\x1b[2J\x7f\u00fc\n").what(), "'a b  [2J \u00fc '");
    EXPECT_STREQ(usage_error("{}", "a\n\n").what(), "a");
    EXPECT_STREQ(usage_error("{}", "a\u009b2Jb").what(), "a\xc2 2Jb"); // CSI in one character
}

TEST(Workers, RunEveryItemOnceForAnyThreadCount) {
    for (int threads : {0, 1, 2, 5}) {
        const Workers workers(threads);
        EXPECT_GE(workers.count(), 1);
        EXPECT_TRUE(threads == 0 || workers.count() == threads);
        std::vector<std::atomic<int>> hits(10'000);
        workers.for_each(hits.size(), [&](size_t i) { ++hits[i]; });
        for (const auto& hit : hits)
            ASSERT_EQ(hit, 1);
    }
}

TEST(Workers, HandOnAnExceptionOfAnItem) {
    const Workers workers(2);
    EXPECT_THROW(workers.for_each(100,
                                  [](size_t i) {
                                      if (i == 57) throw input_error("item {}", i);
                                  }),
                 Error);
    // and work on afterwards
    std::atomic<int> count = 0;
    workers.for_each(100, [&](size_t) { ++count; });
    EXPECT_EQ(count, 100);
}

} // namespace
} // namespace ql
