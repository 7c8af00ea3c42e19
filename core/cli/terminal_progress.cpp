#include "cli/terminal_progress.h"

#include "cli/standard_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace ql::cli {

namespace {

constexpr std::chrono::milliseconds kInterval{250};

std::string shown_rate(double rate) {
    if (rate >= 1e6) return fmt::format("{:.1f} M/s", rate * 1e-6);
    if (rate >= 1e3) return fmt::format("{:.1f} k/s", rate * 1e-3);
    return fmt::format("{:.1f} /s", rate);
}

} // namespace

void TerminalProgress::start(std::string_view what, uint64_t total) {
    finish();
    const std::lock_guard lock(m_mutex);
    m_what = what;
    m_total = total;
    m_done = 0;
    m_start = Clock::now();
    m_next_draw = (m_start + kInterval).time_since_epoch().count();
}

void TerminalProgress::advance(uint64_t steps) {
    m_done += steps;
    const auto now = Clock::now().time_since_epoch().count();
    Clock::rep next = m_next_draw;
    const auto later = now + std::chrono::duration_cast<Clock::duration>(kInterval).count();
    if (now < next || !m_next_draw.compare_exchange_strong(next, later)) return;
    const std::lock_guard lock(m_mutex);
    draw();
}

void TerminalProgress::finish() {
    const std::lock_guard lock(m_mutex);
    erase();
    m_total = 0;
}

void TerminalProgress::draw() {
    if (m_total == 0) return;
    const double seconds = std::chrono::duration<double>(Clock::now() - m_start).count();
    const double done = double(m_done.load());
    const double share = std::min(1.0, done / double(m_total));
    const double left = share > 0 ? seconds * (1 - share) / share : 0;
    print_error(fmt::format("\r\033[K{} {:3.0f} %  {}  {:.0f} s left", m_what, 100 * share,
                            shown_rate(done / std::max(seconds, 1e-9)), left));
    std::fflush(stderr);
    m_drawn = true;
}

void TerminalProgress::erase() {
    if (!m_drawn) return;
    print_error("\r\033[K");
    std::fflush(stderr);
    m_drawn = false;
}

} // namespace ql::cli
