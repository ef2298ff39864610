// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <filesystem>
#include <set>
#include <string>

#include "core/job.h"
#include "core/result.h"

namespace dubsar {

/// What of a bag stays when the bag is replaced.
struct KeptFiles {
  std::filesystem::path folder;  ///< "BAG.kept-1"; empty where there was nothing to keep
  std::size_t files = 0;
};
/// Where they are, for people; empty where there was nothing to keep.
[[nodiscard]] std::string sentence_of(const KeptFiles& kept);

/// Puts everything in a bag but what is `own` (names relative to it) under the same names into a new folder
/// beside it, so that the bag may be removed: what others added or changed is theirs. The bag itself stays as
/// it is (the files are linked, or copied where the file system has no links). Errors: kStorage, kCancelled;
/// then no such folder stays.
[[nodiscard]] Result<KeptFiles> keep_all_but(const std::set<std::string>& own,
                                             const std::filesystem::path& bag, const JobContext& job);

}  // namespace dubsar
