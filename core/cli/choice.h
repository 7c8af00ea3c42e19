// Options whose values are names.
#pragma once

#include "cli/tool.h"

#include <string>
#include <utility>
#include <vector>

namespace ql::cli {

// `value` holds the default, which must be one of the choices.
template<class T>
CLI::Option* add_choice(Tool& tool, const std::string& name, T& value,
                        const std::vector<std::pair<std::string, T>>& choices,
                        const std::string& what) {
    std::vector<std::string> names;
    std::string now;
    for (const auto& [choice, meaning] : choices) {
        names.push_back(choice);
        if (meaning == value) now = choice;
    }
    return tool.app
        .add_option_function<std::string>(
            name,
            [&value, choices](const std::string& text) {
                for (const auto& [choice, meaning] : choices)
                    if (choice == text) value = meaning;
            },
            what)
        ->check(CLI::IsMember(names))
        ->default_str(now);
}

} // namespace ql::cli
