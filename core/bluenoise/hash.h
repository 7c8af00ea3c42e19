// A 64-bit finalizer (Steele, Lea and Flood 2014, SplitMix64) as counter-based random words.
// Thread safe: pure functions.
#pragma once

#include <cstdint>

namespace ql {

constexpr uint64_t mixed(uint64_t x) {
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

} // namespace ql
