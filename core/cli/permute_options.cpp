#include "cli/permute_options.h"

#include "bluenoise/sort.h"
#include "cli/choice.h"

namespace ql::cli {

CLI::Option* add_permute_options(Tool& tool, PermuteOptions& options) {
    CLI::Option* mask = tool.app.add_option("--mask", options.mask, "Mask, PNG or EXR");
    mask->type_name("FILE");
    tool.app.add_option("--channel", options.mask_channel,
                        "Channel of the mask, if it has several");
    tool.app.add_option("--retarget", options.retarget, "Textures of bn-anneal for this mask")
        ->type_name("FILE");
    add_choice<OffsetKind>(
        tool, "--offsets", options.offsets,
        {{"lattice", OffsetKind::lattice}, {"r2", OffsetKind::r2}, {"thesis", OffsetKind::thesis}},
        "How the mask moves from frame to frame");
    tool.app
        .add_option("--block", options.config.block_px,
                    "Side of the blocks that are sorted, pixels; 1: no sort")
        ->check(CLI::Range(1, kMaxSortBlock));
    tool.app.add_flag("--block-jitter", options.jitter, "Another lattice of blocks each frame");
    add_choice<ReprojectMode>(tool, "--reproject", options.config.reproject,
                              {{"off", ReprojectMode::off},
                               {"image", ReprojectMode::image},
                               {"tile", ReprojectMode::tile}},
                              "Follow motion: of the image or by tile");
    tool.app
        .add_option("--refresh", options.config.refresh_frames,
                    "Fresh seeds for every K-th frame; 0: never")
        ->check(CLI::NonNegativeNumber);
    return mask;
}

PermuteInputs read_permute_inputs(Session& session, const PermuteOptions& options) {
    if (options.config.reproject != ReprojectMode::off && options.retarget.empty())
        throw usage_error("--reproject needs --retarget");
    PermuteInputs inputs{
        mask_from_image(session.read_image(options.mask), options.mask_channel, options.mask),
        {},
        options.config};
    for (const std::string& path : options.retarget)
        for (RetargetTexture& texture : retarget_textures(session.read_image_parts(path), path))
            inputs.textures.push_back(std::move(texture));
    inputs.config.offsets = permute_offsets(options.offsets, inputs.mask, inputs.textures);
    inputs.config.block_jitter = options.jitter ? BlockJitter::on : BlockJitter::off;
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
