// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>

#include "acquisition/session_store.h"
#include "archive/report.h"
#include "core/job.h"
#include "core/result.h"
#include "formats/file_label.h"

namespace dubsar {

/// Paths of what a finished run writes into the session.
struct Deliverables {
  std::filesystem::path mesh;          ///< mesh/model.ply
  std::filesystem::path six_views;     ///< export/six_views.png
  std::filesystem::path red_map;       ///< export/red_map.png
  std::filesystem::path report;        ///< export/report.html
  std::filesystem::path poses;         ///< export/poses.json
  std::filesystem::path red_map_json;  ///< export/red_map.json
  std::filesystem::path checklist;     ///< export/checklist.html
  std::filesystem::path wedges;        ///< analysis/wedges.json; not of write_deliverables()
};

/// Writes mesh, pictures, report, checklist page, poses and red map, each atomically and with its checksum in
/// the session; nothing before all is drawn. An empty mesh gives no pictures. Mesh and pictures say of
/// themselves what the label says.
[[nodiscard]] Result<Deliverables> write_deliverables(SessionStore& store, const ReportInput& input,
                                                      const FileLabel& label, JobContext& job);

}  // namespace dubsar
