#include "image/frame_range.h"

#include "base/error.h"

#include <algorithm>
#include <optional>
#include <regex>

namespace ql {

namespace {

constexpr size_t kMaxFrames = 1'000'000;

struct Conversion {
    size_t begin = 0;
    size_t length = 0;
    int digits = 0;
};

std::optional<Conversion> find_conversion(const std::string& pattern) {
    static const std::regex number("%(0([1-9]))?d");
    std::smatch match;
    if (!std::regex_search(pattern, match, number)) {
        if (pattern.find('%') != std::string::npos)
            throw usage_error("{}: expected a frame number written as %04d", pattern);
        return std::nullopt;
    }
    if (std::count(pattern.begin(), pattern.end(), '%') > 1)
        throw usage_error("{}: more than one frame number", pattern);
    return Conversion{size_t(match.position(0)), size_t(match.length(0)),
                      match[2].matched ? std::stoi(match[2].str()) : 0};
}

} // namespace

std::vector<int> parse_frame_range(const std::string& text) {
    static const std::regex piece(R"((\d{1,9})(?:-(\d{1,9})(?:x(\d{1,9}))?)?)");
    std::vector<int> frames;
    for (size_t at = 0; at <= text.size();) {
        const size_t comma = std::min(text.find(',', at), text.size());
        const std::string part = text.substr(at, comma - at);
        std::smatch match;
        if (!std::regex_match(part, match, piece))
            throw usage_error("frame range '{}': expected A, A-B or A-BxS", text);
        const int first = std::stoi(match[1].str());
        const int last = match[2].matched ? std::stoi(match[2].str()) : first;
        const int step = match[3].matched ? std::stoi(match[3].str()) : 1;
        if (last < first || step < 1)
            throw usage_error("frame range '{}': expected a rising range with a step of at least 1",
                              text);
        if (frames.size() + size_t((last - first) / step) + 1 > kMaxFrames)
            throw usage_error("frame range '{}': more than {} frames", text, kMaxFrames);
        for (int frame = first; frame <= last; frame += step)
            frames.push_back(frame);
        at = comma + 1;
    }
    return frames;
}

bool is_numbered(const std::string& pattern) {
    return find_conversion(pattern).has_value();
}

std::string numbered_path(const std::string& pattern, int frame) {
    const auto conversion = find_conversion(pattern);
    if (!conversion) return pattern;
    return pattern.substr(0, conversion->begin) + fmt::format("{:0{}}", frame, conversion->digits) +
           pattern.substr(conversion->begin + conversion->length);
}

} // namespace ql
