// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/result.h"

namespace dubsar {

/// A folder or file that could not be looked at: what lies there is not in the list.
struct UnreadPlace {
  std::string name;    ///< below the folder; "." for the folder itself
  std::string reason;  ///< as the system says it
};

struct AnalysedFiles {
  std::vector<std::filesystem::path> paths;  ///< each once, below the folder, in name order
  std::vector<UnreadPlace> unread;           ///< in name order
  /// Sessions below the folder that have no session.sqlite and no wedges, in name order, by their names as in
  /// `unread`: a copy that broke off, perhaps.
  std::vector<std::string> lost_sessions;
};

/// The .json files at or below a folder that may be a tablet's wedges, each tablet's once
/// (docs/collections.md): of a session wedges.json in SESSION.results beside it, else analysis/wedges.json in
/// it; of a folder with a tablet.ply or model.ply wedges.json, where there is one; elsewhere every .json but
/// truth.json. Hidden files and folders, bags and what was kept aside (NAME.kept-N, NAME.damaged-N) are left
/// out, below the folder: itself it may be any of these, and all of it is meant then. Links are followed; a
/// folder or file that comes again through one is passed over. Errors: kBadInput when there is no such folder
/// or it cannot be read.
[[nodiscard]] Result<AnalysedFiles> analysed_files(const std::filesystem::path& folder);

}  // namespace dubsar
