// bn-anneal: retarget textures, by an exact assignment or by simulated annealing.
#include "bluenoise/offsets.h"
#include "bluenoise/retarget_solve.h"
#include "cli/choice.h"
#include "cli/tool.h"

#include <cmath>

using namespace ql;

namespace {

struct Options {
    std::string mask, channel, step, motion = "0,0", solver = "exact";
    OffsetKind offsets = OffsetKind::lattice;
    std::string schedule = "kirkpatrick", trace, snapshot, output;
    int radius_px = 6;
    int motions = 0;
    bool no_bound = false;
    RetargetConfig problem;
    AnnealConfig anneal;
    FileFormat format = FileFormat::by_extension;
    std::vector<const CLI::Option*> anneal_options;
    const CLI::Option *alpha_option = nullptr, *equilibrium_option = nullptr;
    const CLI::Option *motion_option = nullptr, *offsets_option = nullptr;
};

void add_anneal_options(cli::Tool& tool, Options& options) {
    const auto add = [&](auto&&... arguments) {
        options.anneal_options.push_back(tool.app.add_option(arguments...));
        return tool.app.get_option(options.anneal_options.back()->get_name());
    };
    add("--schedule", options.schedule, "How the temperature falls")
        ->check(CLI::IsMember({"kirkpatrick", "exponential", "inverse", "linear", "hajek"}));
    add("--t0", options.anneal.t0, "First temperature, steps of the mask; 0: accepts everything")
        ->check(CLI::NonNegativeNumber);
    options.alpha_option =
        add("--alpha", options.anneal.alpha, "Rate of cooling, usually 0.8 to 0.99");
    options.equilibrium_option =
        add("--equilibrium", options.anneal.equilibrium,
            "Accepted exchanges before kirkpatrick cools; 0: five per pixel")
            ->check(CLI::NonNegativeNumber);
    add("--steps", options.anneal.steps, "Proposed exchanges; 0: 10000 per pixel")
        ->check(CLI::NonNegativeNumber);
    add("--time-limit", options.anneal.time_limit_seconds,
        "Seconds per texture; 0: none. The result then depends on the machine")
        ->check(CLI::NonNegativeNumber);
    options.anneal_options.push_back(tool.add_seed(options.anneal.seed));
    add("--trace", options.trace, "Write step, temperature, energy and acceptance as CSV")
        ->type_name("FILE");
    add("--snapshot", options.snapshot, "Write the tile as OUTPUT_STEP.png every N proposals")
        ->type_name("every=N");
    options.anneal_options.push_back(
        tool.app.add_flag("--no-bound", options.no_bound, "Do not work out the exact bound"));
}

void add_options(cli::Tool& tool, Options& options) {
    tool.app.add_option("mask", options.mask, "Mask, PNG or EXR")->type_name("MASK")->required();
    tool.app.add_option("--channel", options.channel, "Channel of the mask, if it has several");
    tool.app.add_option("--step", options.step, "Move of the mask from frame to frame, pixels")
        ->type_name("DX,DY");
    options.offsets_option = cli::add_choice<OffsetKind>(
        tool, "--offsets", options.offsets,
        {{"lattice", OffsetKind::lattice}, {"r2", OffsetKind::r2}, {"thesis", OffsetKind::thesis}},
        "Steps of the mask to make textures for");
    tool.app.add_option("--radius", options.radius_px, "Farthest move on each axis, pixels")
        ->check(CLI::Range(0, kMaxRetargetRadius));
    options.motion_option =
        tool.app.add_option("--motion", options.motion, "Move of the surface, pixels")
            ->type_name("DX,DY");
    tool.app
        .add_option("--motions", options.motions, "Textures for all motions up to N on each axis")
        ->check(CLI::Range(0, 16));
    tool.app
        .add_option("--move-penalty", options.problem.move_penalty,
                    "Cost of a move of one pixel, in 1/256 of the mask's range")
        ->check(CLI::Range(0.0, 1000.0));
    tool.app.add_option("--solver", options.solver, "exact: the optimum, with proof")
        ->check(CLI::IsMember({"exact", "anneal"}));
    add_anneal_options(tool, options);
    tool.add_output(options.output, "Retarget texture(s), .exr or .png");
    tool.add_format(options.format);
}

Imath::V2i parse_pair(const std::string& text, const std::string& what) {
    const std::vector<double> numbers = cli::parse_numbers(text, 2, what);
    for (const double number : numbers)
        if (number != std::round(number) || std::abs(number) > 1 << 20)
            throw usage_error("{}: '{}', expected whole pixels", what, text);
    return {int(numbers[0]), int(numbers[1])};
}

int64_t parse_snapshot(const std::string& text) {
    const std::string prefix = "every=";
    if (text.empty()) return 0;
    if (text.starts_with(prefix)) {
        const double every = cli::parse_numbers(text.substr(prefix.size()), 1, "--snapshot")[0];
        if (every >= 1 && every == std::round(every) && every < 1e15) return int64_t(every);
    }
    throw usage_error("--snapshot: '{}', expected every=N", text);
}

void check_combination(Options& options) {
    const bool annealing = options.solver == "anneal";
    for (const CLI::Option* option : options.anneal_options)
        if (!annealing && option->count() > 0)
            throw usage_error("{} needs --solver anneal", option->get_name());
    static const std::map<std::string, AnnealSchedule> schedules = {
        {"kirkpatrick", AnnealSchedule::kirkpatrick},
        {"exponential", AnnealSchedule::exponential},
        {"inverse", AnnealSchedule::inverse},
        {"linear", AnnealSchedule::linear},
        {"hajek", AnnealSchedule::hajek}};
    options.anneal.schedule = schedules.at(options.schedule);
    if (options.equilibrium_option->count() > 0 && options.schedule != "kirkpatrick")
        throw usage_error("--equilibrium is for kirkpatrick, not for {}", options.schedule);
    if (options.alpha_option->count() > 0 &&
        (options.schedule == "linear" || options.schedule == "hajek"))
        throw usage_error("--alpha is not for {}", options.schedule);
    if (options.motions > 0 && options.motion_option->count() > 0)
        throw usage_error("--motion and --motions exclude each other");
    if (!options.step.empty() && options.offsets_option->count() > 0)
        throw usage_error("--step and --offsets exclude each other");
    options.anneal.snapshot_every = parse_snapshot(options.snapshot);
    if (options.anneal.snapshot_every > 0 && options.output == "-")
        throw usage_error("--snapshot needs an output file to name its files after");
    if (!options.trace.empty()) options.anneal.trace_rows = 1000;
}

std::vector<RetargetConfig> problems(const Options& options, const Mask& mask) {
    const int width = mask.values.width(), height = mask.values.height();
    std::vector<Imath::V2i> steps = retarget_steps(mask_offsets(options.offsets, width, height));
    if (!options.step.empty()) {
        const Imath::V2i step = parse_pair(options.step, "--step");
        steps = {{wrap(step.x, width), wrap(step.y, height)}};
    }
    RetargetConfig base = options.problem;
    base.radius_px = options.radius_px;
    if (options.motions > 0) return retarget_set(steps, options.motions, base);
    std::vector<RetargetConfig> configs = retarget_set(steps, 0, base);
    for (RetargetConfig& config : configs)
        config.motion = parse_pair(options.motion, "--motion");
    return configs;
}

// "dir/name" of "dir/name.exr".
std::string stem(const std::string& path) {
    const size_t dot = path.find_last_of('.');
    const size_t slash = path.find_last_of('/');
    const bool has_ending = dot != std::string::npos && (slash == std::string::npos || dot > slash);
    return has_ending ? path.substr(0, dot) : path;
}

void write_snapshot(const Options& options, const RetargetProblem& problem, int64_t step,
                    const Moves& moves, cli::Session& session) {
    Image image(problem.width(), problem.height());
    image.plane("Y") = moved_tile(problem, moves);
    ImageWriteConfig write = session.image_config();
    write.png = problem.levels() <= 256 ? PngEncoding::linear8 : PngEncoding::linear16;
    session.write_image(fmt::format("{}_{:010}.png", stem(options.output), step), image, write);
}

RetargetTexture solve(const Options& options, const Mask& mask, const RetargetConfig& config,
                      uint64_t stream, cli::Session& session) {
    if (options.solver == "exact") {
        RetargetTexture texture = exact_retarget_texture(mask, config);
        session.progress().advance();
        return texture;
    }
    AnnealConfig schedule = options.anneal;
    schedule.stream = stream;
    schedule.on_snapshot = [&](int64_t step, const Moves& moves) {
        write_snapshot(options, RetargetProblem(mask, config), step, moves, session);
    };
    const BoundMode bound = options.no_bound ? BoundMode::none : BoundMode::exact;
    AnnealedTexture annealed =
        annealed_retarget_texture(mask, config, schedule, bound, session.progress());
    if (!options.trace.empty()) session.write_text(options.trace, trace_csv(annealed.run.trace));
    return annealed.texture;
}

cli::Json texture_result(const Options& options, const RetargetTexture& texture,
                         int64_t cost_units) {
    const RetargetReport& report = texture.report;
    cli::Json json;
    json["step"] = {texture.step.x, texture.step.y};
    json["motion"] = {texture.motion.x, texture.motion.y};
    json["energy_initial"] = report.energy_initial;
    json["energy"] = report.energy;
    if (!options.no_bound) json["energy_bound"] = texture.energy_bound;
    json["energy_share"] =
        report.energy_initial > 0 ? double(report.energy) / double(report.energy_initial) : 0.0;
    json["cost"] = double(report.cost) / double(cost_units);
    json["mean_move_px"] = report.mean_move_px;
    json["max_move_px"] = report.max_move_px;
    json["bijection"] = report.bijection;
    return json;
}

void report(const Options& options, const std::vector<RetargetTexture>& textures,
            int64_t cost_units, cli::Session& session) {
    RetargetTexture all = textures.front();
    for (size_t i = 1; i < textures.size(); ++i) {
        const RetargetReport& other = textures[i].report;
        all.report.energy_initial += other.energy_initial;
        all.report.energy += other.energy;
        all.report.cost += other.cost;
        all.report.mean_move_px += other.mean_move_px;
        all.report.max_move_px = std::max(all.report.max_move_px, other.max_move_px);
        all.energy_bound += textures[i].energy_bound;
    }
    all.report.mean_move_px /= double(textures.size());
    cli::Json& result = session.stats().result;
    result = texture_result(options, all, cost_units);
    if (textures.size() == 1) return;
    result.erase("step");
    result.erase("motion");
    result["textures"] = cli::Json::array();
    for (const RetargetTexture& texture : textures)
        result["textures"].push_back(texture_result(options, texture, cost_units));
}

void write(const Options& options, const std::vector<RetargetTexture>& textures,
           cli::Session& session) {
    ImageWriteConfig config = session.image_config();
    config.format = options.format;
    config.png = PngEncoding::linear8;
    const bool png = file_format(options.output, options.format) == FileFormat::png;
    bool one_step = true;
    for (const RetargetTexture& texture : textures)
        one_step = one_step && texture.step == textures.front().step;
    const NamedBy named_by = one_step ? NamedBy::motion : NamedBy::step_and_motion;
    std::vector<Image> parts;
    for (const RetargetTexture& texture : textures) {
        parts.push_back(
            retarget_image(texture, png ? RetargetEncoding::png : RetargetEncoding::exr));
        const std::string name = retarget_name(texture, named_by);
        if (png && textures.size() > 1)
            session.write_image(fmt::format("{}_{}.png", stem(options.output), name), parts.back(),
                                config);
        else
            parts.back().name = name;
    }
    if (!png || textures.size() == 1) session.write_image_parts(options.output, parts, config);
}

void run(Options& options, cli::Session& session) {
    check_combination(options);
    const bool png = file_format(options.output, options.format) == FileFormat::png;
    const Mask mask =
        mask_from_image(session.read_image(options.mask), options.channel, options.mask);
    const std::vector<RetargetConfig> configs = problems(options, mask);
    if (configs.size() > 1 && (!options.trace.empty() || !options.snapshot.empty()))
        throw usage_error("--trace and --snapshot are for one texture, not for {}", configs.size());
    if (configs.size() > 1 && png && options.output == "-")
        throw usage_error("{} textures on standard output need --format exr", configs.size());

    std::vector<RetargetTexture> textures(configs.size());
    {
        const auto timer = session.phase("build");
        const int64_t steps =
            options.anneal.steps > 0 ? options.anneal.steps : 10000 * int64_t(mask.values.size());
        const bool annealing = options.solver == "anneal";
        session.progress().start(annealing ? "proposals" : "textures",
                                 configs.size() * uint64_t(annealing ? steps : 1));
        session.workers().for_each(configs.size(), [&](size_t i) {
            textures[i] = solve(options, mask, configs[i], i, session);
        });
        session.progress().finish();
    }
    write(options, textures, session);
    report(options, textures, RetargetProblem(mask, configs.front()).cost_units(), session);
}

} // namespace

int main(int argc, char** argv) {
    cli::Tool tool({"bn-anneal", "Makes textures that move seeds as a blue-noise mask moves.",
                    "bn-anneal mask.png --motions 4 -o retarget.exr"});
    Options options;
    add_options(tool, options);
    return tool.main(argc, argv, [&](cli::Session& session) { run(options, session); });
}
