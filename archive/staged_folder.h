// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

#include "core/result.h"

namespace dubsar {

/// kUsage where a disk is mounted at the place itself: no folder can be put there, and what is made beside it
/// lies on another disk. To be asked before any work.
[[nodiscard]] Status check_no_disk_is_mounted_at(const std::filesystem::path& target);

/// A folder that is made under a temporary name beside its place and put there whole, or not at all. Taken
/// away again unless it was published.
class StagedFolder {
 public:
  /// Makes the temporary folder, and durably those that it lies in. What a killed program left there is
  /// removed first, the folder itself with it where it is another user's or others may write into it. kUsage
  /// where something lies at `target` already that `replace` does not let go (an empty folder is nothing), or
  /// a disk is mounted there; kStorage where nothing can be made, and while another program is at it, which
  /// is over when that program ends.
  [[nodiscard]] static Result<StagedFolder> begin(const std::filesystem::path& target, bool replace);

  StagedFolder(StagedFolder&& other) noexcept;
  StagedFolder& operator=(StagedFolder&&) = delete;
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;
  ~StagedFolder();

  /// Where to write.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Syncs every folder and takes the place of the target, in one step where something lies there that may be
  /// replaced (the old one is removed only after that). The files must have been synced by whoever wrote
  /// them. kUsage where nothing was to be replaced and somebody has put something there meanwhile: it stays.
  [[nodiscard]] Status publish();

 private:
  StagedFolder(std::filesystem::path target, std::filesystem::path path, int lock, bool replaces)
      : target_(std::move(target)), path_(std::move(path)), lock_(lock), replaces_(replaces) {}

  std::filesystem::path target_;
  std::filesystem::path path_;  ///< empty once there is nothing to take away
  int lock_ = -1;
  bool replaces_ = false;
};

}  // namespace dubsar
