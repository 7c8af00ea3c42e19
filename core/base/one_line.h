// Text of files and users in messages: one line, and nothing that a terminal obeys.
#pragma once

#include <string>

namespace ql {

// Control characters, those of Latin-1 (as UTF-8) too, become spaces; line ends at the end are
// dropped.
inline std::string one_line(std::string text) {
    while (!text.empty() && text.back() == '\n')
        text.pop_back();
    unsigned char before = 0;
    for (char& c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte == 0x7f || (before == 0xc2 && byte >= 0x80 && byte < 0xa0)) c = ' ';
        before = byte;
    }
    return text;
}

// Of the message of a library, which may run over several.
inline std::string first_line(const std::string& text) {
    const std::string line = text.substr(0, text.find('\n'));
    return line.empty() ? "malformed" : line;
}

} // namespace ql
