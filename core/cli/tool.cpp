#include "cli/tool.h"

#include "base/one_line.h"
#include "cli/signals.h"
#include "cli/standard_error.h"
#include "cli/terminal_progress.h"
#include "image/atomic_file.h"
#include "version.h"

#include <fcntl.h>
#include <tbb/global_control.h>
#include <tbb/version.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <limits>
#include <new>
#include <regex>
#include <system_error>

namespace ql::cli {

namespace {

constexpr int kExitCheckFailed = 1;
constexpr int kExitUsage = int(ErrorKind::usage);
constexpr int kExitOutput = int(ErrorKind::output);
constexpr int kExitInternal = int(ErrorKind::internal);
constexpr int kMaxThreads = 1024;

// The date that goes into image headers: SOURCE_DATE_EPOCH, or the library's fixed one.
std::string header_date(const std::string& fallback) {
    const char* epoch = std::getenv("SOURCE_DATE_EPOCH");
    if (!epoch) return fallback;
    char* end = nullptr;
    const long long seconds = std::strtoll(epoch, &end, 10);
    if (end == epoch || *end != '\0')
        throw usage_error("SOURCE_DATE_EPOCH: '{}', expected seconds since 1970", epoch);
    const std::time_t time = std::time_t(seconds);
    std::tm parts = {};
    if (!gmtime_r(&time, &parts)) throw usage_error("SOURCE_DATE_EPOCH: {} is no date", epoch);
    char text[32];
    std::strftime(text, sizeof(text), "%Y:%m:%d %H:%M:%S", &parts);
    return text;
}

// The flag, then OMP_NUM_THREADS, then (0) the affinity mask.
int requested_threads(int flag) {
    if (flag > 0) return flag;
    const char* variable = std::getenv("OMP_NUM_THREADS");
    if (!variable) return 0;
    const int threads = std::atoi(variable);
    return threads > 0 && threads <= kMaxThreads ? threads : 0;
}

// A standard stream that the caller closed must not become the descriptor of the next file that is
// opened. What is put there fails when it is used, as a closed one would.
void occupy_standard_streams() {
    for (int descriptor = 0; descriptor <= 2; ++descriptor)
        if (fcntl(descriptor, F_GETFD) < 0 && errno == EBADF)
            (void)!open("/dev/null", descriptor == 0 ? O_WRONLY : O_RDONLY);
}

// A number where the text is one, the text itself elsewhere.
Json json_value(const std::string& text) {
    const Json parsed = Json::parse(text, nullptr, false);
    return parsed.is_number() || parsed.is_boolean() ? parsed : Json(text);
}

bool takes_numbers(const CLI::Option& option) {
    const std::string type = option.get_type_name(); // with its checks
    return type.find("FLOAT") != type.npos || type.find("POSITIVE") != type.npos ||
           type.find("NONNEGATIVE") != type.npos;
}

// CLI11 takes an empty text for the number 0, lets it pass where it asks for one of several, and
// finds NaN within any range.
void refuse_odd_values(const CLI::App& app) {
    for (const CLI::Option* option : app.get_options())
        for (const std::string& value : option->results()) {
            if (value.empty()) throw usage_error("{}: the value is empty", option->get_name());
            if (takes_numbers(*option) && !std::isfinite(std::strtod(value.c_str(), nullptr)))
                throw usage_error("{}: '{}', expected a finite number", option->get_name(), value);
        }
}

} // namespace

Size parse_size(const std::string& text) {
    static const std::regex pattern(R"((\d{1,7})x(\d{1,7}))");
    std::smatch match;
    if (!std::regex_match(text, match, pattern))
        throw usage_error("'{}' is no size, expected WxH such as 1920x1080", text);
    const Size size{std::stoi(match[1].str()), std::stoi(match[2].str())};
    constexpr int kMaxSide = 1 << 20;
    if (size.width < 1 || size.height < 1 || size.width > kMaxSide || size.height > kMaxSide)
        throw usage_error("'{}': both sides must be in 1..{}", text, kMaxSide);
    return size;
}

std::vector<double> parse_numbers(const std::string& text, size_t count, const std::string& what) {
    std::vector<double> numbers;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (numbers.size() < count) {
        double number = 0;
        const auto [next, error] = std::from_chars(at, end, number);
        if (error != std::errc() || !std::isfinite(number)) break;
        numbers.push_back(number);
        at = next;
        if (numbers.size() == count || at == end || *at != ',') break;
        ++at;
    }
    if (numbers.size() != count || at != end)
        throw usage_error("{}: '{}', expected {} numbers separated by commas", what, text, count);
    return numbers;
}

Session::Session(std::string tool, int threads, std::unique_ptr<Progress> progress, int verbosity)
    : m_tool(std::move(tool)), m_workers(threads), m_progress(std::move(progress)),
      m_verbosity(verbosity) {}

void Session::say(const std::string& kind, const std::string& message) {
    m_progress->finish();
    print_error(fmt::format("{}: {}{}\n", m_tool, kind, one_line(message)));
}

void Session::warn(const std::string& message) {
    if (m_verbosity >= 0) say("warning: ", message);
}

void Session::inform(const std::string& message) {
    if (m_verbosity > 0) say("", message);
}

void Session::fail_check(const std::string& message) {
    if (m_verbosity >= 0) say("", message);
    m_check_failed = true;
}

ImageWriteConfig Session::image_config() const {
    ImageWriteConfig config;
    config.software = fmt::format("quietlight {} {}", m_tool, kVersion);
    config.date_time = header_date(config.date_time);
    return config;
}

void Session::warn_of_saturation(const std::string& path, std::span<const Image> parts) {
    constexpr float kMost = std::numeric_limits<float>::max();
    size_t count = 0;
    for (const Image& part : parts)
        for (const Plane<float>& plane : part.planes) {
            const std::vector<float>& values = plane.pixels.values();
            count += size_t(std::count(values.begin(), values.end(), kMost));
        }
    if (count > 0)
        warn(fmt::format("{}: {} samples are {:g}, the greatest there is, and may stand for more",
                         path, count, kMost));
}

void Session::write_image(const std::string& path, const Image& image,
                          const ImageWriteConfig& config) {
    write_image_parts(path, std::span(&image, 1), config);
}

void Session::write_image_parts(const std::string& path, std::span<const Image> parts,
                                const ImageWriteConfig& config) {
    const PhaseTimer timer = phase("write");
    warn_of_saturation(path, parts);
    ql::write_image_parts(path, parts, config);
    m_stats.output.push_back(path);
}

void Session::write_text(const std::string& path, const std::string& text) {
    const PhaseTimer timer = phase("write");
    write_file(path, text);
    m_stats.output.push_back(path);
}

void Session::print(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size())
        throw output_error("standard output cannot be written ({})", std::strerror(errno));
}

Image Session::read_image(const std::string& path, const ImageReadConfig& config) {
    const PhaseTimer timer = phase("load");
    m_stats.input.push_back(path);
    return ql::read_image(path, config);
}

std::vector<Image> Session::read_image_parts(const std::string& path,
                                             const ImageReadConfig& config) {
    const PhaseTimer timer = phase("load");
    m_stats.input.push_back(path);
    return ql::read_image_parts(path, config);
}

Tool::Tool(ToolInfo info) : app(info.description, info.name), m_info(std::move(info)) {
    app.footer("Example:\n  " + m_info.example);
    app.set_help_flag("-h,--help", "Print this help and exit");
    app.option_defaults()->always_capture_default();
    app.get_formatter()->column_width(34);
    app.add_option("-j,--threads", m_threads, "Threads to use; 0: OMP_NUM_THREADS or all")
        ->check(CLI::Range(0, kMaxThreads))
        ->group("Common");
    app.add_flag("-q,--quiet", m_quiet, "No warnings and no progress")->group("Common");
    app.add_flag("-v,--verbose", m_verbosity, "Print more; with --version also the libraries")
        ->group("Common");
    app.add_option("--progress", m_progress, "Progress on stderr; auto: on a terminal")
        ->check(CLI::IsMember({"auto", "always", "never"}))
        ->group("Common");
    app.add_option("--stats", m_stats_path,
                   "Write timings, counts and results as JSON, see quietlight(7)")
        ->type_name("FILE")
        ->group("Common");
    app.set_config("--config", "", "Read options from a TOML or INI file")
        ->type_name("FILE")
        ->group("Common");
    app.allow_config_extras(CLI::config_extras_mode::error);
    app.add_flag_callback(
           "--version", [] {}, "Print name, version and commit and exit")
        ->group("Common");
}

CLI::Option* Tool::add_seed(uint64_t& seed) {
    return app.add_option("--seed", seed, "Seed of all random numbers");
}

CLI::Option* Tool::add_output(std::string& path, const std::string& what) {
    return app.add_option("-o,--output", path, what + "; - is standard output")
        ->type_name("FILE")
        ->required();
}

CLI::Option* Tool::add_format(FileFormat& format) {
    static const std::map<std::string, FileFormat> names = {{"exr", FileFormat::exr},
                                                            {"png", FileFormat::png}};
    return app
        .add_option_function<std::string>(
            "--format", [&format](const std::string& name) { format = names.at(name); },
            "Format where the name does not tell, as on standard output")
        ->check(CLI::IsMember({"exr", "png"}));
}

CLI::Option* Tool::add_size(Size& size, const std::string& what) {
    return add_size("--size", size, what);
}

CLI::Option* Tool::add_size(const std::string& flags, Size& size, const std::string& what) {
    return app
        .add_option_function<std::string>(
            flags, [&size](const std::string& text) { size = parse_size(text); }, what)
        ->type_name("WxH")
        ->default_str(fmt::format("{}x{}", size.width, size.height));
}

std::string Tool::version() const {
    std::string text = fmt::format("{} {} (git {})\n", m_info.name, kVersion, kGitCommit);
    if (m_verbosity > 0)
        text += fmt::format("{}, oneTBB {}.{}, CLI11 {}, nlohmann-json {}.{}.{}{}\n",
                            image_library_versions(), TBB_VERSION_MAJOR, TBB_VERSION_MINOR,
                            CLI11_VERSION, NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR,
                            NLOHMANN_JSON_VERSION_PATCH, m_libraries);
    return text;
}

int Tool::report(const std::string& message, int status) const {
    print_error(fmt::format("{}: {}\n", m_info.name, one_line(message)));
    return status;
}

// Every option under its long name in snake_case as it was given or else its default, except those
// that say where and how to report. A tool corrects what another option changes.
Json Tool::used_options() const {
    static const std::set<std::string> left_out = {"help",  "version",  "config", "stats",
                                                   "quiet", "progress", "verbose"};
    Json config = Json::object();
    for (const CLI::Option* option : app.get_options()) {
        std::string name = option->get_single_name();
        if (left_out.contains(name)) continue;
        for (char& c : name)
            c = c == '-' ? '_' : char(std::tolower(c));
        const auto results = option->reduced_results();
        if (option->get_items_expected_max() > 1) { // an array, of however many values
            config[name] = Json::array();
            for (const std::string& value : results)
                config[name].push_back(json_value(value));
        } else if (option->count() > 0) {
            config[name] = json_value(results.front());
        } else if (const std::string value = option->get_default_str(); !value.empty()) {
            config[name] = json_value(value);
        }
    }
    return config;
}

// Returns 0 to go on, -1 if all is done, or the exit status of an error.
int Tool::parse(int argc, char** argv) {
    // --version must work without the options that are required otherwise.
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument == "-v" || argument == "--verbose") m_verbosity = 1;
    }
    for (int i = 1; i < argc; ++i)
        if (argv[i] == std::string("--version")) {
            fmt::print("{}", version());
            return -1;
        }
    m_verbosity = 0;
    try {
        app.parse(argc, argv);
        refuse_odd_values(app);
        return 0;
    } catch (const CLI::CallForHelp&) {
        const std::string help = app.help();
        if (std::fwrite(help.data(), 1, help.size(), stdout) != help.size())
            return report("standard output cannot be written", kExitOutput);
        return -1;
    } catch (const CLI::FileError& error) {
        return report(error.what(), int(ErrorKind::input));
    } catch (const CLI::ParseError& error) {
        return report(fmt::format("{} (try {} --help)", one_line(error.what()), m_info.name),
                      kExitUsage);
    }
}

int Tool::run(const std::function<void(Session&)>& body) {
    const int threads = requested_threads(m_threads);
    const bool show = !m_quiet && (m_progress == "always" || (m_progress == "auto" && isatty(2)));
    Session session(m_info.name, threads,
                    show ? std::make_unique<TerminalProgress>() : std::make_unique<Progress>(),
                    m_quiet ? -1 : m_verbosity);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    size_t(session.workers().count()));
    set_image_threads(session.workers().count());
    session.stats().config = used_options();
    {
        const PhaseTimer total = session.phase("total");
        body(session);
    }
    session.progress().finish();
    if (!m_stats_path.empty())
        write_file(m_stats_path, json_text(session.stats().document(m_info.name)));
    return session.check_failed() ? kExitCheckFailed : 0;
}

int Tool::main(int argc, char** argv, const std::function<void(Session&)>& body) {
    occupy_standard_streams();
    install_signal_handlers();
    int status = 0;
    try {
        status = parse(argc, argv);
        if (status == 0)
            status = run(body);
        else if (status < 0)
            status = 0;
    } catch (const Error& error) {
        const bool usage = error.kind() == ErrorKind::usage;
        status = report(usage ? fmt::format("{} (try {} --help)", error.what(), m_info.name)
                              : error.what(),
                        int(error.kind()));
    } catch (const std::bad_alloc&) {
        status = report("out of memory", kExitOutput);
    } catch (const std::system_error& error) { // such as a thread that cannot be started
        status = report(fmt::format("the system refuses: {}", error.code().message()), kExitOutput);
    } catch (const std::exception& error) {
        status = report(fmt::format("internal error: {}", error.what()), kExitInternal);
    }
    // What stayed in the buffer of standard output may fail only now.
    if (std::fclose(stdout) != 0 && status == 0)
        status = report("standard output cannot be written", kExitOutput);
    return status;
}

} // namespace ql::cli
