#include "cli/permute_options.h"

#include "bluenoise/sort.h"

namespace ql::cli {

CLI::Option* add_permute_options(Tool& tool, PermuteOptions& options) {
    CLI::Option* mask = tool.app.add_option("--mask", options.mask, "Mask, PNG or EXR");
    mask->type_name("FILE");
    tool.app.add_option("--channel", options.mask_channel,
                        "Channel of the mask, if it has several");
    tool.app.add_option("--retarget", options.retarget, "Textures of bn-anneal for this mask")
        ->type_name("FILE");
    tool.app.add_option("--offsets", options.offsets, "How the mask moves from frame to frame")
        ->check(CLI::IsMember({"lattice", "r2", "thesis"}));
    tool.app
        .add_option("--block", options.config.block_px,
                    "Side of the blocks that are sorted, pixels; 1: no sort")
        ->check(CLI::Range(1, kMaxSortBlock));
    tool.app.add_flag("--block-jitter", options.jitter, "Another lattice of blocks each frame");
    tool.app.add_option("--reproject", options.reproject, "Follow motion: of the image or by tile")
        ->check(CLI::IsMember({"off", "image", "tile"}));
    tool.app
        .add_option("--refresh", options.config.refresh_frames,
                    "Fresh seeds for every K-th frame; 0: never")
        ->check(CLI::NonNegativeNumber);
    return mask;
}

PermuteInputs read_permute_inputs(Session& session, const PermuteOptions& options) {
    if (options.reproject != "off" && options.retarget.empty())
        throw usage_error("--reproject needs --retarget");
    PermuteInputs inputs{
        mask_from_image(session.read_image(options.mask), options.mask_channel, options.mask),
        {},
        options.config};
    for (const std::string& path : options.retarget)
        for (RetargetTexture& texture : retarget_textures(session.read_image_parts(path), path))
            inputs.textures.push_back(std::move(texture));
    inputs.config.offsets =
        permute_offsets(offset_kind(options.offsets), inputs.mask, inputs.textures);
    inputs.config.block_jitter = options.jitter ? BlockJitter::on : BlockJitter::off;
    if (options.reproject == "image") inputs.config.reproject = ReprojectMode::image;
    if (options.reproject == "tile") inputs.config.reproject = ReprojectMode::tile;
    return inputs;
}

Array2D<uint32_t> read_seeds(Session& session, const std::string& path) {
    const Image image = session.read_image(path);
    const Array2D<uint32_t>* seeds = image.find_uint("seed");
    if (!seeds)
        throw input_error("{}: channels {}, expected an unsigned channel 'seed'", path,
                          image.channel_names());
    return *seeds;
}

} // namespace ql::cli
