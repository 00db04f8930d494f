#pragma once

namespace batten::command {

/// Puts something in the place of standard streams that are closed, so that no file opened later
/// passes for one: reading or writing them fails as before.
void fill_closed_streams();

/// Writes out what was printed; throws FileError when any of it could not be written.
void finish_standard_output();

} // namespace batten::command
