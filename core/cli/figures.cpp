#include "cli/figures.h"

#include "base/error.h"
#include "cli/tool.h"

#include <cmath>
#include <cstdint>
#include <regex>

namespace ql::cli {

namespace {

// Without the sign that a NaN may have.
std::string digits(double value) {
    return std::isnan(value) ? "nan" : fmt::format("{:.9g}", value);
}

} // namespace

std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text)
        quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + "\"";
}

Json as_json(const Figures& figures) {
    Json json = Json::object();
    constexpr double kExactIntegers = 9007199254740992; // 2^53
    for (const auto& [name, value] : figures)
        if (!std::isfinite(value))
            json[name] = digits(value);
        else if (value == std::floor(value) && std::abs(value) < kExactIntegers)
            json[name] = int64_t(value);
        else
            json[name] = value;
    return json;
}

std::string formatted(const Figures& figures, FigureForm form,
                      const std::vector<std::pair<std::string, std::string>>& labels) {
    std::string text;
    if (form == FigureForm::text) {
        for (const auto& [name, value] : figures)
            text += fmt::format("{} {}\n", name, digits(value));
        return text;
    }
    if (form == FigureForm::json) {
        Json json = Json::object();
        for (const auto& [name, label] : labels)
            json[name] = label;
        json.update(as_json(figures));
        return json_text(json);
    }
    std::string row;
    const auto append = [&](const std::string& name, const std::string& value) {
        text += (text.empty() ? "" : ",") + csv_field(name);
        row += (row.empty() ? "" : ",") + csv_field(value);
    };
    for (const auto& [name, label] : labels)
        append(name, label);
    for (const auto& [name, value] : figures)
        append(name, digits(value));
    return text + "\n" + row + "\n";
}

Condition parse_condition(const std::string& text) {
    static const std::regex pattern(
        R"(\s*([A-Za-z_][\w.,-]{0,79}?)\s*(<=|>=|==|!=|<|>)\s*(\S{1,40})\s*)");
    std::smatch match;
    if (!std::regex_match(text, match, pattern))
        throw usage_error("'{}': expected a condition such as low_frequency_share<0.02", text);
    return {match[1].str(), match[2].str(), parse_numbers(match[3].str(), 1, "'" + text + "'")[0]};
}

bool holds(double figure, const Condition& condition) {
    if (std::isnan(figure)) return false;
    const std::string& op = condition.comparison;
    if (op == "<") return figure < condition.value;
    if (op == "<=") return figure <= condition.value;
    if (op == ">") return figure > condition.value;
    if (op == ">=") return figure >= condition.value;
    if (op == "==") return figure == condition.value;
    QL_CHECK(op == "!=");
    return figure != condition.value;
}

double figure_value(const Figures& figures, const std::string& name) {
    std::string names;
    for (const auto& [other, value] : figures) {
        if (other == name) return value;
        names += (names.empty() ? "" : ", ") + other;
    }
    throw usage_error("no figure {} among {}", name, names);
}

} // namespace ql::cli
