// How long-running algorithms report how far they are. This base class reports nothing.
#pragma once

#include <cstdint>
#include <string_view>

namespace ql {

class Progress {
  public:
    virtual ~Progress() = default;
    // Begins a stage of `total` steps; ends the stage before it.
    virtual void start(std::string_view /*what*/, uint64_t /*total*/) {}
    // Safe to call from any thread.
    virtual void advance(uint64_t /*steps*/ = 1) {}
    virtual void finish() {}
};

} // namespace ql
