// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

#include "core/result.h"

namespace dubsar::session {

/// Held by the one program that writes; the system lets go of it when that program ends, however it ends.
///
/// A copy of a session by hard links (cp -al) shares the file: as long as a program that was there before the
/// copy was made writes to either, the other is refused, since the tables are shared as well. The next
/// program puts a lock of its own in place, and what it locks is one session again.
class FolderLock {
 public:
  /// kStorage with the process number, and the computer where that is another, when another program (or
  /// another store of this one) has it. kBadInput where a symbolic link, or what is no file, lies in place of
  /// the lock.
  [[nodiscard]] static Result<FolderLock> take(const std::filesystem::path& folder);
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&& other) noexcept;
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

  /// Whether it is still the lock of what lies there: the folder may have been moved, or the file taken away.
  [[nodiscard]] bool is_of(const std::filesystem::path& folder) const;

 private:
  explicit FolderLock(int fd) : fd_(fd) {}
  /// In place of one that has other names too. While that is held.
  [[nodiscard]] static Result<FolderLock> put_own(const std::filesystem::path& path);
  void note_process() const;

  int fd_ = -1;
};

}  // namespace dubsar::session
