// Text to standard error. A stream that takes none is no reason to fail: fmt::print would throw.
#pragma once

#include <cstdio>
#include <string>

namespace ql::cli {

inline void print_error(const std::string& text) {
    (void)std::fwrite(text.data(), 1, text.size(), stderr);
}

} // namespace ql::cli
