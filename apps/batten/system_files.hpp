#pragma once

#include <batten/io/output_place.hpp>
#include <batten/system/system_sums.hpp>

#include <string>
#include <vector>

namespace batten::command {

/// Asked before anything is read: throws InvalidInput or FileError for an output that is no file
/// of a saved system, cannot be written, or is also read.
void check_system_output(const std::string& output, const std::vector<FileUse>& inputs);

/// Writes the system and says what is in it.
void write_system(const std::string& output, const SystemSums& sums, bool quiet);

/// What is in a saved system, in a line.
std::string system_words(const SystemSums& sums);

} // namespace batten::command
