// Named figures that a tool prints, and conditions on them that decide its exit status.
#pragma once

#include "cli/stats.h"

#include <string>
#include <utility>
#include <vector>

namespace ql::cli {

using Figures = std::vector<std::pair<std::string, double>>; // name and value, in printing order

enum class FigureForm { text, json, csv };

// text: a line "name value" each. json: one object, led by `labels`. csv: a header and a row, led
// by `labels`. Values have nine digits; in JSON those that are not finite are "inf", "-inf", "nan".
std::string formatted(const Figures& figures, FigureForm form,
                      const std::vector<std::pair<std::string, std::string>>& labels);

Json as_json(const Figures& figures);

// A field of a CSV file, in quotes where its text needs them (RFC 4180).
std::string csv_field(const std::string& text);

// "name op number" with op one of < <= > >= == !=
struct Condition {
    std::string name;
    std::string comparison;
    double value = 0;
};

// Errors: ErrorKind::usage.
Condition parse_condition(const std::string& text);

// False for NaN, whatever the comparison.
bool holds(double figure, const Condition& condition);

// The value of a figure. Errors: ErrorKind::usage with the names there are.
double figure_value(const Figures& figures, const std::string& name);

} // namespace ql::cli
