// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/session_wedges.h"

#include <fmt/format.h>

#include "archive/wedge_drawing.h"
#include "core/log.h"
#include "formats/wedges_json.h"
#include "station/analysis.h"

namespace dubsar {

namespace fs = std::filesystem;

Result<std::optional<SessionWedges>> keep_wedges(SessionStore& store, const Mesh& mesh,
                                                 const JobContext& job) {
  if (mesh.faces.empty()) {
    return std::nullopt;
  }
  const AnalysisOptions options;
  const Result<Analysis> analysis = analyze_mesh(mesh, options, job);
  if (!analysis) {
    if (analysis.error().kind != ErrorKind::kBadInput) {
      return std::unexpected(analysis.error());
    }
    log_warning("wedges were not looked for: " + analysis.error().line());
    return std::nullopt;
  }
  const fs::path folder = store.folder() / "analysis";
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    return fail(ErrorKind::kStorage, error.message(), folder.string(),
                "free some space or choose another folder");
  }
  const WedgeFile file = wedge_file("model.ply", options, *analysis);
  SessionWedges out{folder / "wedges.json", file.wedges.size(), file.rejected.size()};
  if (const Status forgotten = store.forget_files({"analysis/"}); !forgotten) {
    return std::unexpected(forgotten.error());
  }
  if (const Status written = write_wedges(out.json, file); !written) {
    return std::unexpected(written.error());
  }
  std::vector<fs::path> made{out.json};
  if (file.text_from_model && !file.wedges.empty()) {
    const auto drawings =
        write_wedge_drawings(folder, file.wedges, *file.text_from_model, store.folder().filename().string());
    if (!drawings) {
      return std::unexpected(drawings.error());
    }
    made.insert(made.end(), drawings->begin(), drawings->end());
  }
  for (const fs::path& path : made) {
    if (const Status kept = store.record_file(fs::relative(path, store.folder())); !kept) {
      return std::unexpected(kept.error());
    }
  }
  return out;
}

std::string wedge_sentence(const SessionWedges& wedges) {
  if (wedges.count == 0) {
    return fmt::format("No wedges were found; {} hollows were looked at.", wedges.rejected);
  }
  return fmt::format(
      "{} wedges were measured, {} hollows were rejected: analysis/wedges.json has every angle, the drawings "
      "beside it every wedge. Wedge measurement was tested on simulated tablets only.",
      wedges.count, wedges.rejected);
}

}  // namespace dubsar
