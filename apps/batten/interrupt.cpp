#include "interrupt.hpp"

#include <csignal>

namespace batten::command {

namespace {

volatile std::sig_atomic_t pressed = 0;

extern "C" void on_interrupt(int signal) {
    pressed = 1;
    std::signal(signal, SIG_DFL);
}

} // namespace

void watch_interrupts() {
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
}

bool interrupted() {
    return pressed != 0;
}

} // namespace batten::command
