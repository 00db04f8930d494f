#pragma once

namespace batten::command {

/// How the command ends.
enum ExitStatus {
    done = 0,
    wrong_input = 2,
    machine_trouble = 3, ///< files, memory, threads
    not_within = 4,
    interrupted = 130,
};

} // namespace batten::command
