// The `--stats` object: what a tool read, wrote, needed, and how long it took.
//
// The schema is documented in quietlight(7) and pinned by a test. Keys are snake_case with units.
#pragma once

#include <nlohmann/json.hpp>

#include <chrono>
#include <string>

namespace ql::cli {

using Json = nlohmann::ordered_json;

// Indented, with an end of line. Names of files need not be UTF-8: what is not becomes U+FFFD.
std::string json_text(const Json& json);

struct Stats {
    Json config = Json::object();
    Json input = Json::array();
    Json output = Json::array();
    Json scene = Json::object();
    Json seconds = Json::object();
    Json rays = Json::object();
    Json result = Json::object();
    uint64_t discarded_samples = 0;

    Json document(const std::string& tool) const;
};

// Adds the time from its construction to its destruction to stats.seconds[name].
class PhaseTimer {
  public:
    PhaseTimer(Stats& stats, std::string name);
    ~PhaseTimer();
    PhaseTimer(const PhaseTimer&) = delete;
    PhaseTimer& operator=(const PhaseTimer&) = delete;

  private:
    Stats& m_stats;
    std::string m_name;
    std::chrono::steady_clock::time_point m_start;
};

} // namespace ql::cli
