// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "core/job.h"
#include "core/result.h"

namespace dubsar {

/// What was done to a damaged session. Names are relative to its folder.
struct Mended {
  std::vector<std::string> notes;      ///< what opening rebuilt, one line each
  std::vector<std::string> records;    ///< rows of the tables, from the copy ("events row 12")
  std::vector<std::string> restored;   ///< from the copy
  std::vector<std::string> made_anew;  ///< derived files, from the scans and poses; whole ones that had to be
                                       ///< replaced among them
  std::vector<std::string> set_aside;  ///< originals, under the names that they have now
  std::vector<Error> beyond;           ///< what could not be made anew
};

/// Mends what verify() found in a session with what there is: its tables from their readable rows, their
/// backup, the copy's where one is given and is of the same session, and the headers of the grids; grids and
/// other files from that copy; mesh, pictures and pages from scans and poses; wedges from the mesh. What is
/// whole stays, but for wedges, drawings and pages of a mesh that is lost and comes as another one: those are
/// kept aside. A grid that no copy has cannot be mended: it is left as it is. Nothing damaged is overwritten.
/// Errors: the session cannot be written, another program has it, kCancelled.
[[nodiscard]] Result<Mended> mend_session(const std::filesystem::path& session, const VerifyReport& found,
                                          const std::optional<std::filesystem::path>& copy, JobContext& job);

}  // namespace dubsar
