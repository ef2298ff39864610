// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/deliverables.h"

#include <algorithm>
#include <functional>

#include "archive/behind_page.h"
#include "archive/png.h"
#include "archive/report_pictures.h"
#include "formats/atomic_file.h"
#include "formats/make_folder.h"
#include "formats/mesh_io.h"
#include "formats/poses_json.h"
#include "formats/red_map_json.h"
#include "station/kept_surface.h"
#include "station/picture_file.h"
#include "station/selected_mesh.h"
#include "station/session_pages.h"

namespace dubsar {

namespace fs = std::filesystem;

namespace {

/// Whether a file, by its name in the session, is to be written.
using Wanted = std::function<bool(const std::string&)>;

Result<Deliverables> write_wanted(SessionStore& store, const ReportInput& input, const FileLabel& label,
                                  const Wanted& wanted, JobContext& job) {
  Deliverables files;
  for (const char* name : {"mesh", "export"}) {
    if (const Status made = make_folder(store.folder() / name); !made) {
      return std::unexpected(made.error());
    }
  }
  const auto keep = [&](const char* name, fs::path& into, const auto& write) {
    if (!wanted(name)) {
      return Status();
    }
    Status kept = store.replace_file(name, write);
    if (kept) {
      into = store.folder() / name;
    }
    return kept;
  };
  const auto keep_text = [&](const char* name, fs::path& into, const std::string& text) {
    return keep(name, into, [&](const fs::path& file) { return write_file_atomically(file, text); });
  };

  job.progress("writing results", 0.0);
  const Result<ReportPictures> pictures = draw_pictures(input, job);
  if (!pictures) {
    return std::unexpected(pictures.error());
  }
  const Result<std::string> report = report_html(input, *pictures);
  if (!report) {
    return std::unexpected(report.error());
  }
  job.progress("writing results", 0.5);
  if (!input.model.faces.empty()) {
    const auto write = [&](const fs::path& file) { return write_mesh(file, input.model, label); };
    if (Status s = keep(kSessionMesh, files.mesh, write); !s) {
      return std::unexpected(s.error());
    }
  }
  if (pictures->empty) {
    // Those of an earlier surface must not stay beside it.
    const Image none = behind_picture(
        {input.title, {}, input.when, "no surface was meshed", "run dubsar plan once a scan is registered"});
    for (const char* name : {"export/six_views.png", "export/red_map.png"}) {
      std::error_code unknown;
      const auto draw = [&](const fs::path& file) {
        return write_picture(file, none, picture_words(label, input.title));
      };
      fs::path unused;
      if (Status s = fs::exists(store.folder() / name, unknown) ? keep(name, unused, draw) : Status(); !s) {
        return std::unexpected(s.error());
      }
    }
  } else {
    const auto writer = [&](const auto& sheet, const char* what) {
      return [&label, &input, &sheet, what](const fs::path& file) {
        return write_picture(file, sheet, picture_words(label, input.title + ", " + what));
      };
    };
    if (Status s = keep("export/six_views.png", files.six_views, writer(pictures->sides_sheet, "six sides"));
        !s) {
      return std::unexpected(s.error());
    }
    if (Status s = keep("export/red_map.png", files.red_map, writer(pictures->red_sheet, "red map")); !s) {
      return std::unexpected(s.error());
    }
  }
  if (Status s = keep_text("export/report.html", files.report, *report); !s) {
    return std::unexpected(s.error());
  }
  if (Status s = keep_text("export/checklist.html", files.checklist, checklist_html(input, *pictures)); !s) {
    return std::unexpected(s.error());
  }
  if (Status s = keep_text("export/poses.json", files.poses, poses_to_json(input.scans)); !s) {
    return std::unexpected(s.error());
  }
  if (Status s = keep_text("export/red_map.json", files.red_map_json, red_map_to_json(input.red_map)); !s) {
    return std::unexpected(s.error());
  }
  job.progress("writing results", 1.0);
  return files;
}

}  // namespace

Result<Deliverables> write_deliverables(SessionStore& store, const ReportInput& input, const FileLabel& label,
                                        JobContext& job) {
  return write_wanted(
      store, input, label, [](const std::string&) { return true; }, job);
}

Result<Deliverables> write_named(SessionStore& store, const ReportInput& input, const FileLabel& label,
                                 const std::vector<std::string>& names, JobContext& job) {
  const auto is_named = [&](const std::string& name) {
    return std::ranges::find(names, name) != names.end();
  };
  return write_wanted(store, input, label, is_named, job);
}

Status write_pages(SessionStore& store, const ReportInput& input, const FileLabel& label, JobContext& job) {
  const auto is_page = [](const std::string& name) { return name != kSessionMesh; };
  const Result<Deliverables> files = write_wanted(store, input, label, is_page, job);
  return files ? Status() : std::unexpected(files.error());
}

}  // namespace dubsar
