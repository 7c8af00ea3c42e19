// A progress line on standard error: stage, share, rate and time left, at most four a second.
#pragma once

#include "base/progress.h"

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>

namespace ql::cli {

class TerminalProgress : public Progress {
  public:
    // What follows, an error message perhaps, begins on a clean line.
    ~TerminalProgress() override { finish(); }
    void start(std::string_view what, uint64_t total) override;
    void advance(uint64_t steps = 1) override;
    void finish() override;

  private:
    using Clock = std::chrono::steady_clock;
    void draw();
    void erase();

    std::mutex m_mutex;
    std::string m_what;
    std::atomic<uint64_t> m_done = 0;
    uint64_t m_total = 0;
    Clock::time_point m_start;
    std::atomic<Clock::rep> m_next_draw = 0;
    bool m_drawn = false;
};

} // namespace ql::cli
