// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/job.h"
#include "core/result.h"

namespace dubsar {

/// What a check of a bag found. Names are relative to the bag.
struct BagReport {
  std::string version;                  ///< "1.0"; empty where bagit.txt does not say it
  std::vector<std::string> algorithms;  ///< of the payload manifests that were checked
  std::vector<Error> damaged;           ///< everything that keeps the bag from being complete and valid
  std::vector<std::string> whole;       ///< files whose checksums fit, tag files included, and those that are
                                        ///< whole though the line of a manifest is damaged
  std::vector<std::string> unrecorded;  ///< tag files that no tag manifest lists: allowed
  std::vector<std::string> unchecked;   ///< manifests with checksums that this program does not know
  [[nodiscard]] bool ok() const { return damaged.empty(); }
};

/// True when the folder declares itself a bag (bagit.txt), or has lost that and holds a manifest and a
/// payload.
[[nodiscard]] bool is_bag(const std::filesystem::path& folder);

/// Whether "Bag-Software-Agent: Dubsar 0.1.0" stands in this bag-info.txt.
[[nodiscard]] bool is_written_by_dubsar(const std::string& bag_info);

/// Whether a bag is complete and valid (RFC 8493, section 3): every payload file in every manifest and the
/// other way round, every checksum that digest_named() knows, the tag manifests (one at
/// least where Dubsar wrote the bag), Payload-Oxum, and nothing that leads out of the bag. Where a file is
/// whole and a line of a manifest is damaged, that line is named (bag_doubt.h). Reads every byte; changes
/// nothing. Errors: kCancelled; all else is in the report.
[[nodiscard]] Result<BagReport> check_bag(const std::filesystem::path& folder, JobContext& job);

}  // namespace dubsar
