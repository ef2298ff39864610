// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "core/job.h"
#include "core/known_wedge.h"
#include "core/mesh.h"
#include "core/result.h"
#include "core/wedge_correction.h"
#include "formats/wedges_json.h"

namespace dubsar {

/// The wedges of a session's mesh, as kept in its folder.
struct SessionWedges {
  std::filesystem::path json;  ///< analysis/wedges.json; a drawing of each written side lies beside it
  std::size_t count = 0;
  std::size_t rejected = 0;
  std::string by_hand;                 ///< correction_sentence()
  std::vector<std::string> doubts;     ///< doubts_of(), sentences without their mends
  std::vector<WedgeProfile> profiles;  ///< make_read_profiles()
};

/// What the scholar has said of the session's wedges in the viewer; a file that cannot be read is passed over
/// with a warning.
[[nodiscard]] std::vector<WedgeCorrection> session_corrections(const SessionStore& store);

/// The wedges that the session's file tells of, present and former.
[[nodiscard]] std::vector<KnownWedge> session_known_wedges(const SessionStore& store);

/// The wedges of a session's mesh with what was said of them, under the ids that they had among the known.
/// Nothing when the mesh has no surface to look at. Errors: kCancelled.
[[nodiscard]] Result<std::optional<WedgeFile>> measure_wedges(const Mesh& mesh,
                                                              const std::vector<WedgeCorrection>& corrections,
                                                              std::vector<KnownWedge> known,
                                                              const JobContext& job);

/// Measures the wedges of the mesh, corrected as the session says, and keeps them in the session. Nothing
/// when the mesh has no surface to look at. Errors: kCancelled, kStorage.
[[nodiscard]] Result<std::optional<SessionWedges>> keep_wedges(SessionStore& store, const Mesh& mesh,
                                                               const JobContext& job);

/// What the wedges are that the session keeps, whatever has become of their file.
enum class KeptWedges {
  kOfAnotherSurface,   ///< or there are none
  kMeasuredOtherwise,  ///< on this one, in another way, or with other corrections than the session has now
  kAsMeasuredNow
};
[[nodiscard]] KeptWedges kept_wedges(const SessionStore& store, const Mesh& mesh);

/// Those that were measured as now, when their file is as it was stored; nothing otherwise.
[[nodiscard]] std::optional<WedgeFile> stored_wedges(const SessionStore& store, const Mesh& mesh,
                                                     const JobContext& job);

/// "A person has corrected what was found: 3 corrections were made, and 1 more could not be." Empty where
/// nobody has.
[[nodiscard]] std::string correction_sentence(const WedgeFile& file);

/// What is told of the wedges of this file, which `json` leads to.
[[nodiscard]] SessionWedges counts_of(const WedgeFile& file, std::filesystem::path json);

/// One sentence on them, for pages. where: their file, as the reader of the page finds it.
[[nodiscard]] std::string wedge_sentence(const SessionWedges& wedges,
                                         const std::string& where = "analysis/wedges.json");

}  // namespace dubsar
