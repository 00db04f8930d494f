#pragma once

namespace batten::command {

/// Registers STEP and IGES: their module is loaded when such a file is first read or written.
void register_cad_formats();

} // namespace batten::command
