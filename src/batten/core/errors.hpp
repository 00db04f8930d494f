#pragma once

#include <stdexcept>
#include <string>

namespace batten {

/// The caller's mistake: an argument breaks a stated rule. The message names the thing, its value
/// and the rule.
class InvalidInput : public std::invalid_argument {
  public:
    using std::invalid_argument::invalid_argument;
};

/// Equalities that cannot all hold, over the control points that there are.
class ConstraintConflict : public InvalidInput {
  public:
    using InvalidInput::InvalidInput;
};

/// A file that cannot be read or written as asked. The message starts with `path:` or
/// `path:line:column:`.
class FileError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A numerical breakdown inside a solver on input that was legal.
class SolverError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The caller asked to stop before there was an answer (FitOptions::cancelled).
class Cancelled : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

} // namespace batten
