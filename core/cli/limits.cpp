#include "cli/limits.h"

namespace ql::cli {

namespace {

constexpr const char* kGroup = "Limits (exit status 1)";

struct OneSided {
    const char* option;
    const char* figure;
    Limit::Side side;
};
constexpr OneSided kOneSided[] = {
    {"--max-mse", "mse", Limit::Side::at_most},
    {"--max-rmse", "rmse", Limit::Side::at_most},
    {"--max-relmse", "relmse", Limit::Side::at_most},
    {"--max-block-relmse", "block_relmse", Limit::Side::at_most},
    {"--max-abs", "max_abs", Limit::Side::at_most},
    {"--max-perceptual", "perceptual_", Limit::Side::at_most},
    {"--min-psnr", "psnr_db", Limit::Side::at_least},
};

} // namespace

void add_limits(Tool& tool, std::vector<Limit>& limits) {
    for (const OneSided& entry : kOneSided)
        tool.app
            .add_option_function<std::string>(
                entry.option,
                [&limits, entry](const std::string& text) {
                    limits.push_back({entry.option, entry.figure, entry.side,
                                      parse_numbers(text, 1, entry.option)[0]});
                },
                fmt::format("Fail if {} is {}", entry.figure,
                            entry.side == Limit::Side::at_most ? "above" : "below"))
            ->type_name("LIMIT")
            ->group(kGroup);
    tool.app
        .add_option_function<std::string>(
            "--mean-ratio",
            [&limits](const std::string& text) {
                const auto range = parse_numbers(text, 2, "--mean-ratio");
                limits.push_back({"--mean-ratio", "mean_ratio", Limit::Side::at_least, range[0]});
                limits.push_back({"--mean-ratio", "mean_ratio", Limit::Side::at_most, range[1]});
            },
            "Fail if mean_ratio is outside")
        ->type_name("LO,HI")
        ->group(kGroup);
}

void check_limits(const Figures& figures, const std::vector<Limit>& limits, Session& session) {
    for (const Limit& limit : limits)
        for (const auto& [name, value] : figures) {
            const bool stem = limit.figure.ends_with('_') && name.starts_with(limit.figure);
            if (name != limit.figure && !stem) continue;
            // Written so that NaN fails
            const bool above = limit.side == Limit::Side::at_most;
            const bool holds = above ? value <= limit.value : value >= limit.value;
            if (!holds)
                session.fail_check(fmt::format("{} is {:.9g}, {} {} {:.9g}", name, value,
                                               above ? "above" : "below", limit.option,
                                               limit.value));
        }
}

} // namespace ql::cli
