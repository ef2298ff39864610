// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include "core/job.h"
#include "core/result.h"
#include "station/done_stamp.h"

namespace dubsar {

/// The files of a package, relative to it, that Dubsar wrote and nobody has changed: all else in it is
/// somebody else's, whatever the manifests say, for programs for bags write those anew when files are added.
/// With the stamp that lay beside the package: the outputs that it lists, where their bytes are still the
/// same. Without: what the package's own provenance lists, with its pages on formats and its manifests, where
/// the manifests have the same bytes; not bag-info.txt, where others write too. Empty where there is no
/// package. Errors: kStorage, kCancelled.
[[nodiscard]] Result<std::set<std::string>> own_files_of(const std::filesystem::path& package,
                                                         const std::optional<DoneStamp>& stamp,
                                                         JobContext& job);

}  // namespace dubsar
