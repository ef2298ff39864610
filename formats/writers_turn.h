// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

#include "core/result.h"

namespace dubsar {

/// The turn of one writer in a folder, for files that are read, changed and written again: from take() until
/// it goes, whoever else asks for it waits, be it a thread or a program of this computer. Programs on other
/// computers that share the folder do not, nor does anyone where folders cannot be locked (NFS). Held by the
/// folder, for each writing puts another file in the place of the old one; the system ends it with the
/// program.
class WritersTurn {
 public:
  /// Errors: kStorage.
  [[nodiscard]] static Result<WritersTurn> take(const std::filesystem::path& folder);
  WritersTurn(WritersTurn&& other) noexcept;
  WritersTurn& operator=(WritersTurn&&) = delete;
  WritersTurn(const WritersTurn&) = delete;
  WritersTurn& operator=(const WritersTurn&) = delete;
  ~WritersTurn();

 private:
  explicit WritersTurn(int fd) : fd_(fd) {}
  int fd_;
};

}  // namespace dubsar
