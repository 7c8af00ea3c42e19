// What all tools share: common options, exit statuses, signals, progress, warnings, --stats.
//
// A tool declares its options on `app`, then hands its work to main():
//
//     int main(int argc, char** argv) {
//         cli::Tool tool({"bn-mask", "...", "bn-mask --size 64x64 -o mask.png"});
//         Options options;
//         tool.add_output(options.output, "mask, .png or .exr");
//         ...
//         return tool.main(argc, argv, [&](cli::Session& session) { run(options, session); });
//     }
#pragma once

#include "base/parallel.h"
#include "base/progress.h"
#include "cli/stats.h"
#include "image/image_file.h"

#include <CLI/CLI.hpp>

#include <functional>
#include <memory>
#include <string>

namespace ql::cli {

struct ToolInfo {
    std::string name;
    std::string description; // one sentence
    std::string example;     // one command line
};

struct Size {
    int width = 0;
    int height = 0;
};

// What run() is handed: the surroundings of one invocation.
class Session {
  public:
    Session(std::string tool, int threads, std::unique_ptr<Progress> progress, int verbosity);

    const Workers& workers() const { return m_workers; }
    Progress& progress() { return *m_progress; }
    Stats& stats() { return m_stats; }
    PhaseTimer phase(const std::string& name) { return {m_stats, name}; }

    // One line on standard error each, unless --quiet.
    void warn(const std::string& message);
    // Said with -v only.
    void inform(const std::string& message);
    // A check that the user asked for did not hold: exit status 1 at the end of run().
    void fail_check(const std::string& message);
    bool check_failed() const { return m_check_failed; }

    // Settings with name, version and date filled in.
    ImageWriteConfig image_config() const;
    // Writes and lists the file under `output`, timed as the phase "write".
    void write_image(const std::string& path, const Image& image, const ImageWriteConfig& config);
    void write_image_parts(const std::string& path, std::span<const Image> parts,
                           const ImageWriteConfig& config);
    void write_text(const std::string& path, const std::string& text);
    // Text on standard output, terminal or not.
    void print(const std::string& text);
    // Reads and lists the file under `input`, timed as the phase "load".
    Image read_image(const std::string& path, const ImageReadConfig& config = {});
    std::vector<Image> read_image_parts(const std::string& path,
                                        const ImageReadConfig& config = {});

  private:
    void say(const std::string& kind, const std::string& message);
    void warn_of_saturation(const std::string& path, std::span<const Image> parts);

    std::string m_tool;
    Workers m_workers;
    std::unique_ptr<Progress> m_progress;
    Stats m_stats;
    int m_verbosity;
    bool m_check_failed = false;
};

class Tool {
  public:
    explicit Tool(ToolInfo info);

    CLI::App app;

    // Options that several tools have, with the same meaning in each.
    // To be named by --version --verbose, beside those of all tools.
    void add_library(const std::string& name_and_version) {
        m_libraries += ", " + name_and_version;
    }
    bool is_given(const std::string& option) const { return app.get_option(option)->count() > 0; }

    CLI::Option* add_seed(uint64_t& seed);
    CLI::Option* add_output(std::string& path, const std::string& what);
    CLI::Option* add_format(FileFormat& format);
    CLI::Option* add_size(Size& size, const std::string& what);
    CLI::Option* add_size(const std::string& flags, Size& size, const std::string& what);

    // Parses, runs the body, writes --stats; returns the exit status.
    int main(int argc, char** argv, const std::function<void(Session&)>& body);

  private:
    int parse(int argc, char** argv);
    int run(const std::function<void(Session&)>& body);
    int report(const std::string& message, int status) const;
    Json used_options() const;
    std::string version() const;

    ToolInfo m_info;
    int m_threads = 0;
    bool m_quiet = false;
    int m_verbosity = 0;
    std::string m_progress = "auto";
    std::string m_stats_path;
    std::string m_libraries; // of this tool alone
};

// Accepts "WxH" with both sides in [1, 2^20].
Size parse_size(const std::string& text);

// Finite numbers separated by commas, exactly `count` of them. Errors: ErrorKind::usage.
std::vector<double> parse_numbers(const std::string& text, size_t count, const std::string& what);

} // namespace ql::cli
