// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/job.h"
#include "core/result.h"
#include "formats/bag_check.h"

namespace dubsar {

/// What was brought back into a bag. Names are relative to it.
struct BagRepair {
  std::vector<std::string> restored;               ///< from the copy
  std::optional<std::filesystem::path> set_aside;  ///< folder with the damaged originals, beside the bag
};

/// Brings back what `found` says is damaged or missing in a bag from another copy of the same bag: one that
/// has the same list of checksums. A file is taken only where its bytes in the copy are those of that list;
/// the copy may be damaged in other files. Damaged originals go into a folder of their own beside the bag,
/// each is replaced whole. Errors: kUsage: the copy is no bag, or of another package; kStorage; kCancelled.
[[nodiscard]] Result<BagRepair> repair_bag(const std::filesystem::path& bag, const BagReport& found,
                                           const std::filesystem::path& copy, JobContext& job);

}  // namespace dubsar
