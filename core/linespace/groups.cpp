#include "linespace/groups.h"

#include <algorithm>

namespace ql {

std::vector<uint32_t> ShaftGroups::holding(std::span<const uint32_t> numbers) const {
    std::vector<char> has(size());
    for (const uint32_t number : numbers) {
        const uint32_t group = of_shaft(number);
        has[group] = has[*of_group(group)] = 1;
    }
    std::vector<uint32_t> groups;
    for (uint32_t group = 0; group < size(); ++group)
        if (has[group]) groups.push_back(group);
    return groups;
}

} // namespace ql
