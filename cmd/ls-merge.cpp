// ls-merge: adds Linespace caches of different photons of one run.
#include "cli/tool.h"
#include "linespace/cache_file.h"

namespace {

using namespace ql;

struct Options {
    std::vector<std::string> inputs;
    std::string output;
};

void run(const Options& o, cli::Session& session) {
    if (o.output != "-") file_format(o.output, FileFormat::exr);
    const std::string date_time = session.image_config().date_time;
    LightCache sum;
    for (const std::string& path : o.inputs) {
        const auto timer = session.phase("load");
        session.stats().input.push_back(path);
        LightCache next = read_cache(path);
        sum = sum.first.empty() ? std::move(next) : merged(sum, next, path);
    }
    const auto timer = session.phase("write");
    session.stats().output.push_back(o.output);
    write_cache(o.output, sum, date_time);
    session.stats().result = {{"photons", sum.header.photon_count()}, {"shafts", sum.size()}};
}

} // namespace

int main(int argc, char** argv) {
    cli::Tool tool({"ls-merge", "Adds Linespace caches of different photons of one run.",
                    "ls-merge a.exr b.exr -o all.exr"});
    Options options;
    tool.app.add_option("caches", options.inputs, "Caches of the same scene, grid and seed")
        ->type_name("CACHE")
        ->required();
    tool.add_output(options.output, "Cache, deep .exr");
    return tool.main(argc, argv, [&](cli::Session& session) { run(options, session); });
}
