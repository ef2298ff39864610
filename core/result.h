// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <expected>
#include <string>
#include <string_view>
#include <utility>

namespace dubsar {

/// Who can act on an error; decides the exit status of the command (docs: design.md, contracts).
enum class ErrorKind {
  kUsage,      ///< the caller asked for something that does not exist: status 2
  kBadInput,   ///< outside bytes are not what they claim to be: status 2
  kDevice,     ///< a device or its driver failed: status 3
  kStorage,    ///< the disk refused (full, read-only, damaged): status 4, nothing stored is lost
  kCancelled,  ///< the operator stopped it: status 1
  kInternal,   ///< a defect of the program: status 4
};

/// An error that an operator can act on: what went wrong, where, and the mend. One line each, no trailing
/// dot.
struct Error {
  ErrorKind kind = ErrorKind::kInternal;
  std::string what;
  std::string where;  ///< file, device or scan; may be empty
  std::string mend;   ///< what to do; may be empty

  /// "where: what; mend" on one line, with control characters of outside text replaced.
  [[nodiscard]] std::string line() const;
};

template <class T>
using Result = std::expected<T, Error>;
using Status = Result<void>;

/// The exit status of the command for an error of this kind.
[[nodiscard]] int exit_status(ErrorKind kind);

[[nodiscard]] inline std::unexpected<Error> fail(ErrorKind kind, std::string what, std::string where = {},
                                                 std::string mend = {}) {
  return std::unexpected(Error{kind, std::move(what), std::move(where), std::move(mend)});
}
[[nodiscard]] inline std::unexpected<Error> bad_input(std::string where, std::string what,
                                                      std::string mend = {}) {
  return fail(ErrorKind::kBadInput, std::move(what), std::move(where), std::move(mend));
}

}  // namespace dubsar
