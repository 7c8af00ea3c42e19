// SIGINT, SIGTERM and SIGHUP remove temporary files and then end the process by that very signal.
// SIGXFSZ is ignored: then writing fails, and the tool says so.
#pragma once

namespace ql::cli {

void install_signal_handlers();

} // namespace ql::cli
