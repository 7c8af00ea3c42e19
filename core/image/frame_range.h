// Frame ranges "A-BxS" and numbered file names "out.%04d.exr".
#pragma once

#include <string>
#include <vector>

namespace ql {

// "7", "1-24", "1-100x5", "1-3,8,10-12". Errors: ErrorKind::usage.
std::vector<int> parse_frame_range(const std::string& text);

// The pattern with its one "%d" or "%0Nd" replaced. Errors: ErrorKind::usage for any other
// conversion or a second one.
std::string numbered_path(const std::string& pattern, int frame);

// True if the pattern has a frame number in it.
bool is_numbered(const std::string& pattern);

} // namespace ql
