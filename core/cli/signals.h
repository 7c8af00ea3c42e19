// SIGINT, SIGTERM and SIGHUP remove temporary files and then end the process by that very signal.
#pragma once

namespace ql::cli {

void install_signal_handlers();

} // namespace ql::cli
