// Limits on error figures that decide the exit status: --max-mse and the like.
#pragma once

#include "cli/figures.h"
#include "cli/tool.h"

namespace ql::cli {

struct Limit {
    std::string option; // as given, for the message
    std::string figure; // its name, or the stem of several: perceptual_
    enum class Side { at_most, at_least } side;
    double value;
};

// --max-mse, --max-rmse, --max-relmse, --max-block-relmse, --max-abs, --max-perceptual, --min-psnr,
// --mean-ratio
void add_limits(Tool& tool, std::vector<Limit>& limits);

// Fails the session's check for each limit that a figure breaks; NaN breaks every limit.
void check_limits(const Figures& figures, const std::vector<Limit>& limits, Session& session);

} // namespace ql::cli
