#pragma once

namespace batten::command {

/// From now on the first Ctrl-C only sets a flag, so that work stops at a clean place; a second one
/// ends at once.
void watch_interrupts();

/// Whether Ctrl-C was pressed.
bool interrupted();

} // namespace batten::command
