// Looks through the chunks of a PNG before libpng does, which takes some damage for a warning.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace ql {

// The chunks are whole, their check sums hold, and the last one is IEND. `name` is for messages.
// Errors: ErrorKind::input.
void check_png(std::span<const std::byte> bytes, const std::string& name);

// The checked file with what makes up its pixels only: no profiles, text or other extras.
std::vector<std::byte> bare_png(std::span<const std::byte> bytes, const std::string& name);

} // namespace ql
