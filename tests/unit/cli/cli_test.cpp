#include "cli/figures.h"
#include "cli/image_options.h"
#include "cli/terminal_progress.h"
#include "cli/tool.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <thread>

namespace ql::cli {
namespace {

TEST(ParseSize, TakesBothSidesFromOneToTwoToTheTwenty) {
    EXPECT_EQ(parse_size("1920x1080").width, 1920);
    EXPECT_EQ(parse_size("1x1048576").height, 1048576);
    for (const char* text : {"", "x", "10", "10x", "x10", "0x1", "1x0", "-1x1", "1048577x1",
                             "1x1x1", " 1x1", "1X1", "99999999999x1", "1.5x1"})
        EXPECT_THROW(parse_size(text), Error) << text;
}

TEST(ParseNumbers, TakesJustSoManyFiniteNumbers) {
    EXPECT_EQ(parse_numbers("1,-2.5,3e2", 3, "x"), (std::vector<double>{1, -2.5, 300}));
    for (const char* text : {"", "1,2", "1,2,3,4", "1,2,", "1,,3", "1,2,3,", "a,b,c", "1 ,2,3",
                             "nan,1,2", "inf,1,2", "1e999,1,2", "1,2,3x"})
        EXPECT_THROW(parse_numbers(text, 3, "x"), Error) << text;
}

TEST(ParseRectangle, TakesWholeNumbersThatFit) {
    const Rectangle r = parse_rectangle("0,2,30,4");
    EXPECT_EQ(r.x, 0);
    EXPECT_EQ(r.y, 2);
    EXPECT_EQ(r.width, 30);
    EXPECT_EQ(r.height, 4);
    for (const char* text : {"1,2,3", "-1,0,1,1", "0,0,0,1", "0,0,1,0", "0.5,0,1,1", "3e9,0,1,1"})
        EXPECT_THROW(parse_rectangle(text), Error) << text;
}

TEST(Figures, AreFormattedInThreeWays) {
    const Figures figures = {{"a", 1.0 / 3}, {"b", INFINITY}, {"c", NAN}};
    EXPECT_EQ(formatted(figures, FigureForm::text, {{"image", "x"}}),
              "a 0.333333333\nb inf\nc nan\n");
    EXPECT_EQ(formatted(figures, FigureForm::csv, {{"image", "x,\"y\""}}),
              "image,a,b,c\n\"x,\"\"y\"\"\",0.333333333,inf,nan\n");
    const Json json = Json::parse(formatted(figures, FigureForm::json, {{"image", "\xff"}}));
    EXPECT_EQ(json["a"].get<double>(), 1.0 / 3);
    EXPECT_EQ(json["b"], "inf");
    EXPECT_EQ(json["c"], "nan");
}

TEST(Conditions, HaveSixComparisonsOfWhichNoneHoldsForNan) {
    struct Case {
        const char* text;
        bool below, equal, above;
    };
    for (const auto& [text, below, equal, above] :
         {Case{"f<1", true, false, false}, Case{"f<=1", true, true, false},
          Case{"f>1", false, false, true}, Case{"f>=1", false, true, true},
          Case{"f==1", false, true, false}, Case{" f != 1 ", true, false, true}}) {
        const Condition condition = parse_condition(text);
        EXPECT_EQ(condition.name, "f");
        EXPECT_EQ(condition.value, 1);
        EXPECT_EQ(holds(0, condition), below) << text;
        EXPECT_EQ(holds(1, condition), equal) << text;
        EXPECT_EQ(holds(2, condition), above) << text;
        EXPECT_FALSE(holds(NAN, condition)) << text;
    }
    EXPECT_EQ(parse_condition("filtered_variance_0.7px<-1e-3").name, "filtered_variance_0.7px");
    EXPECT_EQ(parse_condition("a<-1e-3").value, -1e-3);
    for (const char* text : {"", "<1", "a", "a<", "a=1", "a<b", "a<1<2", "a b<1", "a<nan", "1<2"})
        EXPECT_THROW(parse_condition(text), Error) << text;
}

TEST(Conditions, UnknownFiguresAreNamedWithTheKnownOnes) {
    const Figures figures = {{"a", 1}, {"b", 2}};
    EXPECT_EQ(figure_value(figures, "b"), 2);
    try {
        figure_value(figures, "c");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        EXPECT_NE(std::string(error.what()).find("a, b"), std::string::npos);
    }
}

TEST(Stats, HaveTheDocumentedKeysInTheirOrder) {
    const Json document = Stats().document("tool");
    std::vector<std::string> keys;
    for (const auto& [key, value] : document.items())
        keys.push_back(key);
    EXPECT_EQ(keys, (std::vector<std::string>{"schema", "tool", "version", "config", "input",
                                              "output", "scene", "seconds", "rays",
                                              "peak_memory_bytes", "discarded_samples", "result"}));
    EXPECT_GT(document["peak_memory_bytes"].get<uint64_t>(), 0u);
}

TEST(Stats, PhasesOfTheSameNameAddUp) {
    Stats stats;
    { const PhaseTimer timer(stats, "load"); }
    const double first = stats.seconds["load"].get<double>();
    { const PhaseTimer timer(stats, "load"); }
    EXPECT_GT(first, 0);
    EXPECT_GT(stats.seconds["load"].get<double>(), first);
}

TEST(TerminalProgress, LeavesACleanLineWhenItGoesAway) {
    testing::internal::CaptureStderr();
    {
        TerminalProgress progress;
        progress.start("work", 1000);
        for (int i = 0; i < 4; ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
            progress.advance();
        }
    }
    const std::string text = testing::internal::GetCapturedStderr();
    EXPECT_NE(text.find("work"), std::string::npos);
    EXPECT_EQ(text.find('\n'), std::string::npos);
    EXPECT_TRUE(text.ends_with("\r\033[K"));
}

} // namespace
} // namespace ql::cli
