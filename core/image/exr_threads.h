// The threads of the OpenEXR library, which has one pool for the process.
#pragma once

namespace ql {

// Starts the threads that set_image_threads() allowed. To be called before a file is opened: a tool
// that opens none starts none. Errors: std::system_error, if there are no threads to be had.
void start_exr_threads();

} // namespace ql
