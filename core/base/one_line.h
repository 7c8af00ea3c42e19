// Text of files and users in messages: one line, and nothing that a terminal obeys.
#pragma once

#include <string>

namespace ql {

// Control characters become spaces; line ends at the end are dropped.
inline std::string one_line(std::string text) {
    while (!text.empty() && text.back() == '\n')
        text.pop_back();
    for (char& c : text)
        if ((c >= 0 && c < 0x20) || c == 0x7f) c = ' ';
    return text;
}

} // namespace ql
