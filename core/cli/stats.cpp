#include "cli/stats.h"

#include "version.h"

#include <sys/resource.h>

namespace ql::cli {

namespace {

uint64_t peak_memory_bytes() {
    rusage usage = {};
    getrusage(RUSAGE_SELF, &usage);
    return uint64_t(usage.ru_maxrss) * 1024;
}

} // namespace

std::string json_text(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json Stats::document(const std::string& tool) const {
    Json document;
    document["schema"] = 1;
    document["tool"] = tool;
    document["version"] = kVersion;
    document["config"] = config;
    document["input"] = input;
    document["output"] = output;
    document["scene"] = scene;
    document["seconds"] = seconds;
    document["rays"] = rays;
    document["peak_memory_bytes"] = peak_memory_bytes();
    document["discarded_samples"] = discarded_samples;
    document["result"] = result;
    return document;
}

PhaseTimer::PhaseTimer(Stats& stats, std::string name)
    : m_stats(stats), m_name(std::move(name)), m_start(std::chrono::steady_clock::now()) {}

PhaseTimer::~PhaseTimer() {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - m_start;
    Json& total = m_stats.seconds[m_name];
    total = (total.is_number() ? total.get<double>() : 0.0) + elapsed.count();
}

} // namespace ql::cli
