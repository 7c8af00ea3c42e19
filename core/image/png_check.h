// Whether a PNG file is whole: signature, chunk lengths and checksums, IHDR first and IEND last.
//
// Source: PNG specification, third edition, sections 5 and 11. libpng accepts a file that ends
// before IEND, and prints about damage on standard error.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace ql {

// Empty if it is whole, else what is wrong with it. Bytes behind IEND are not looked at.
std::string png_damage(std::span<const std::byte> bytes);

} // namespace ql
