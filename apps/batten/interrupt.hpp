#pragma once

namespace batten::command {

/// From now on Ctrl-C, SIGTERM and SIGHUP end the command at once, whatever it is doing: temporary
/// files are removed, one line says so, the exit status is 130. While outputs get their names they
/// wait. A signal that was ignored when the command started (nohup) stays ignored; a closed pipe
/// and a full file are errors of writing, not signals. To be called by the main thread.
void watch_signals();

} // namespace batten::command
