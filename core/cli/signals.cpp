#include "cli/signals.h"

#include "image/atomic_file.h"

#include <csignal>

namespace ql::cli {

namespace {

extern "C" void clean_up_and_die(int signal_number) {
    remove_temporary_files();
    // Die by the signal, so that shells and make see an interrupt and not a failure.
    std::signal(signal_number, SIG_DFL);
    std::raise(signal_number);
}

} // namespace

void install_signal_handlers() {
    std::signal(SIGXFSZ, SIG_IGN); // a file beyond `ulimit -f` is an error of write()
    for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction before = {};
        sigaction(signal_number, nullptr, &before);
        if (before.sa_handler == SIG_IGN) continue; // nohup and background jobs keep ignoring
        struct sigaction action = {};
        action.sa_handler = clean_up_and_die;
        sigfillset(&action.sa_mask);
        sigaction(signal_number, &action, nullptr);
    }
}

} // namespace ql::cli
