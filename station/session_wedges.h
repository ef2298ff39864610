// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "acquisition/session_store.h"
#include "core/job.h"
#include "core/mesh.h"
#include "core/result.h"

namespace dubsar {

/// The wedges of a session's mesh, as kept in its folder.
struct SessionWedges {
  std::filesystem::path json;  ///< analysis/wedges.json; a drawing of each written side lies beside it
  std::size_t count = 0;
  std::size_t rejected = 0;
};

/// Measures the wedges of the mesh and keeps them in the session. Nothing when the mesh has no surface to
/// look at. Errors: kCancelled, kStorage.
[[nodiscard]] Result<std::optional<SessionWedges>> keep_wedges(SessionStore& store, const Mesh& mesh,
                                                               const JobContext& job);

/// One sentence on them, for pages.
[[nodiscard]] std::string wedge_sentence(const SessionWedges& wedges);

}  // namespace dubsar
