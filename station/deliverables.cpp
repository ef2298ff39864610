// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/deliverables.h"

#include "archive/png.h"
#include "archive/report_pictures.h"
#include "formats/atomic_file.h"
#include "formats/make_folder.h"
#include "formats/mesh_io.h"
#include "formats/poses_json.h"
#include "formats/red_map_json.h"
#include "station/picture_file.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

}  // namespace

std::vector<fs::path> Deliverables::all() const {
  std::vector<fs::path> files;
  for (const fs::path* file : {&mesh, &six_views, &red_map, &report, &checklist, &poses, &red_map_json}) {
    if (!file->empty()) {
      files.push_back(*file);
    }
  }
  return files;
}

std::vector<std::string> deliverable_names() {
  return {"mesh/model.ply",        "export/six_views.png", "export/red_map.png", "export/report.html",
          "export/checklist.html", "export/poses.json",    "export/red_map.json"};
}

Result<Deliverables> write_deliverables(const fs::path& session, const ReportInput& input,
                                        const FileLabel& label, JobContext& job) {
  Deliverables files;
  for (const char* name : {"mesh", "export"}) {
    if (const Status made = make_folder(session / name); !made) {
      return std::unexpected(made.error());
    }
  }
  const auto keep = [](Status status, const fs::path& made, fs::path& into) {
    if (status) {
      into = made;
    }
    return status;
  };

  job.progress("writing results", 0.0);
  const Result<ReportPictures> pictures = draw_pictures(input, job);
  if (!pictures) {
    return std::unexpected(pictures.error());
  }
  job.progress("writing results", 0.5);
  if (!input.model.faces.empty()) {
    const fs::path mesh = session / "mesh" / "model.ply";
    if (Status s = keep(write_mesh(mesh, input.model, label), mesh, files.mesh); !s) {
      return std::unexpected(s.error());
    }
  }
  if (!pictures->empty) {
    const fs::path six_views = session / "export" / "six_views.png";
    const auto words = [&](const char* what) { return picture_words(label, input.title + ", " + what); };
    if (Status s = keep(write_picture(six_views, pictures->sides_sheet, words("six sides")), six_views,
                        files.six_views);
        !s) {
      return std::unexpected(s.error());
    }
    const fs::path red_map = session / "export" / "red_map.png";
    if (Status s =
            keep(write_picture(red_map, pictures->red_sheet, words("red map")), red_map, files.red_map);
        !s) {
      return std::unexpected(s.error());
    }
  }
  const Result<std::string> report = report_html(input, *pictures);
  if (!report) {
    return std::unexpected(report.error());
  }
  const std::string checklist = checklist_html(input, *pictures);
  const auto text = [&](const fs::path& file, const std::string& content, fs::path& into) {
    return keep(write_file_atomically(file, content), file, into);
  };
  if (Status s = text(session / "export" / "report.html", *report, files.report); !s) {
    return std::unexpected(s.error());
  }
  if (Status s = text(session / "export" / "checklist.html", checklist, files.checklist); !s) {
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
