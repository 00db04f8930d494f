#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace batten::cad {

/// Starts `program`, hands it `request` as its standard input and returns what it writes back there
/// before it ends. The program gets the caller's process number as its argument, has a process
/// group of its own and none of the caller's files. Throws Failed when it cannot be started or ends
/// by a signal or with a status, Cancelled as soon as `cancelled` (may be empty) says so; it is
/// then ended. Safe in a program with threads.
std::string answer_of(const std::filesystem::path& program, std::string_view request,
                      const std::function<bool()>& cancelled);

} // namespace batten::cad
