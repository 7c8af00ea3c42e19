// The one exception type of the suite and the process exit status that each kind stands for.
//
// Errors are thrown where data enters or leaves (reading, writing, checking a Config), never per
// sample. The message is one line: what, where, what was expected.
#pragma once

#include "base/one_line.h"

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace ql {

// The values are the exit statuses that the tools document.
enum class ErrorKind { usage = 2, input = 3, output = 4, internal = 5 };

class Error : public std::runtime_error {
  public:
    Error(ErrorKind kind, const std::string& message)
        : std::runtime_error(one_line(message)), m_kind(kind) {}
    ErrorKind kind() const { return m_kind; }

  private:
    ErrorKind m_kind;
};

template<class... Args>
Error usage_error(fmt::format_string<Args...> format, Args&&... args) {
    return {ErrorKind::usage, fmt::format(format, std::forward<Args>(args)...)};
}

template<class... Args>
Error input_error(fmt::format_string<Args...> format, Args&&... args) {
    return {ErrorKind::input, fmt::format(format, std::forward<Args>(args)...)};
}

template<class... Args>
Error output_error(fmt::format_string<Args...> format, Args&&... args) {
    return {ErrorKind::output, fmt::format(format, std::forward<Args>(args)...)};
}

} // namespace ql
