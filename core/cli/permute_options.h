// Options of the passes between frames, shared by the tools that permute seeds.
#pragma once

#include "bluenoise/permute.h"
#include "cli/tool.h"

#include <string>
#include <vector>

namespace ql::cli {

struct PermuteOptions {
    std::string mask, mask_channel;
    std::vector<std::string> retarget;
    OffsetKind offsets = OffsetKind::lattice;
    bool jitter = false;
    PermuteConfig config; // but for the offsets of the mask
};

// Returns the option --mask, so that a tool can require it.
CLI::Option* add_permute_options(Tool& tool, PermuteOptions& options);

// The mask and the textures as read, and the configuration that fits them.
struct PermuteInputs {
    Mask mask;
    std::vector<RetargetTexture> textures;
    PermuteConfig config;
};
PermuteInputs read_permute_inputs(Session& session, const PermuteOptions& options);

// The plane "seed" of a file. Errors: ErrorKind::input.
Array2D<uint32_t> read_seeds(Session& session, const std::string& path);

} // namespace ql::cli
