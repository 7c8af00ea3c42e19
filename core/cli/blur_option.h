// --blur of the Linespace tools.
#pragma once

#include "linespace/blur.h"

#include <string>

namespace ql::cli {

// "0.05" in metres, "0.25vox" in voxels. Errors: ErrorKind::usage.
BlurRadius parse_blur(const std::string& text);

} // namespace ql::cli
