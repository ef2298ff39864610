// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/deliverables.h"

#include "archive/png.h"
#include "archive/six_views.h"
#include "formats/atomic_file.h"
#include "formats/mesh_io.h"
#include "formats/poses_json.h"
#include "formats/red_map_json.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

Status write_sheet(const fs::path& file, const RenderScene& scene, const ReportInput& input,
                   RenderStyle style, const std::string& title, JobContext& job) {
  SixViewOptions options;
  options.tablet_from_model = input.tablet_from_model;
  options.render.longest_px = input.longest_px;
  options.render.style = style;
  const Result<Image> sheet = render_six_view_sheet(scene, options, job);
  if (!sheet) {
    return std::unexpected(sheet.error());
  }
  const auto png = encode_png(*sheet, title);
  if (!png) {
    return std::unexpected(png.error());
  }
  return write_file_atomically(file, std::as_bytes(std::span(*png)));
}

}  // namespace

Result<Deliverables> write_deliverables(const fs::path& session, const ReportInput& input, JobContext& job) {
  Deliverables files;
  std::error_code error;
  fs::create_directories(session / "mesh", error);
  fs::create_directories(session / "export", error);
  if (error) {
    return fail(ErrorKind::kStorage, error.message(), session.string(),
                "free some space or choose another folder");
  }
  const auto keep = [](Status status, const fs::path& made, fs::path& into) {
    if (status) {
      into = made;
    }
    return status;
  };

  job.progress("writing results", 0.0);
  if (!input.model.faces.empty()) {
    const fs::path mesh = session / "mesh" / "model.ply";
    if (Status s = keep(write_mesh(mesh, input.model), mesh, files.mesh); !s) {
      return std::unexpected(s.error());
    }
    const fs::path six_views = session / "export" / "six_views.png";
    if (Status s = keep(
            write_sheet(six_views, RenderScene(input.model), input, RenderStyle::kClay, input.title, job),
            six_views, files.six_views);
        !s) {
      return std::unexpected(s.error());
    }
    job.progress("writing results", 0.3);
    const fs::path red_map = session / "export" / "red_map.png";
    const ColouredPoints* red = input.red_points.positions_mm.empty() ? nullptr : &input.red_points;
    if (Status s = keep(write_sheet(red_map, RenderScene(input.model, red), input, RenderStyle::kRedMap,
                                    input.title + ", red map", job),
                        red_map, files.red_map);
        !s) {
      return std::unexpected(s.error());
    }
  }
  job.progress("writing results", 0.5);
  const Result<std::string> report = report_html(input, job);
  if (!report) {
    return std::unexpected(report.error());
  }
  const auto text = [&](const fs::path& file, const std::string& content, fs::path& into) {
    return keep(write_file_atomically(file, content), file, into);
  };
  if (Status s = text(session / "export" / "report.html", *report, files.report); !s) {
    return std::unexpected(s.error());
  }
  if (Status s = text(session / "export" / "poses.json", poses_to_json(input.scans), files.poses); !s) {
    return std::unexpected(s.error());
  }
  if (Status s =
          text(session / "export" / "red_map.json", red_map_to_json(input.red_map), files.red_map_json);
      !s) {
    return std::unexpected(s.error());
  }
  job.progress("writing results", 1.0);
  return files;
}

}  // namespace dubsar
