#include "interrupt.hpp"

#include "exit_status.hpp"
#include "progress.hpp"

#include <batten/io/output_set.hpp>
#include <batten/io/staged_names.hpp>

#include <csignal>
#include <string_view>
#include <unistd.h>

namespace batten::command {

namespace {

pthread_t main_thread;
volatile std::sig_atomic_t ending = 0;

void say(std::string_view words) {
    [[maybe_unused]] const ssize_t count = ::write(STDERR_FILENO, words.data(), words.size());
}

extern "C" void on_interrupt(int signal) {
    // files are made by the main thread, which holds signals back where it must not be interrupted
    if (::pthread_equal(::pthread_self(), main_thread) == 0) {
        ::pthread_kill(main_thread, signal);
        return;
    }
    if (ending != 0) ::_exit(interrupted); // the first one may be waiting to say its line
    ending = 1;
    remove_staged_files();
    if (progress_is_shown()) say(erased_line);
    say(any_put_in_place() ? "batten: interrupted after the files were written\n"
                           : "batten: interrupted; nothing was written\n");
    ::_exit(interrupted);
}

void watch(int signal) {
    struct sigaction action {};
    ::sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_IGN) return;
    action = {};
    action.sa_handler = on_interrupt;
    action.sa_flags = SA_NODEFER | SA_RESTART;
    ::sigaction(signal, &action, nullptr);
}

} // namespace

void watch_signals() {
    main_thread = ::pthread_self();
    for (int signal : {SIGINT, SIGTERM, SIGHUP}) watch(signal);
    for (int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
}

} // namespace batten::command
