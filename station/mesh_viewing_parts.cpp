// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is done with a part of the mesh that is looked at: kept, written, analysed alone.
#include <algorithm>
#include <utility>

#include "archive/wedge_table.h"
#include "formats/atomic_file.h"
#include "formats/mesh_io.h"
#include "formats/ply_of_unknown_unit.h"
#include "formats/wedges_json.h"
#include "formats/writers_turn.h"
#include "station/analysis.h"
#include "station/earlier_wedges.h"
#include "station/mesh_viewing.h"
#include "station/place_outside.h"
#include "station/selection_store.h"

namespace dubsar {

namespace fs = std::filesystem;

namespace {

/// Another one that has the name stays; the very same is not kept twice.
void keep_under_free_name(MeshSelection selection, std::vector<MeshSelection>* all) {
  const std::string name = selection.name;
  for (int k = 2;; ++k) {
    const auto there = std::ranges::find(*all, selection.name, &MeshSelection::name);
    if (there == all->end()) {
      all->push_back(std::move(selection));
      return;
    }
    if (*there == selection) {
      return;
    }
    selection.name = name + ' ' + std::to_string(k);
  }
}

}  // namespace

void MeshViewing::take_selections(const fs::path& file) {
  const std::shared_ptr<const Mesh> whole = mesh();
  Result<std::vector<MeshSelection>> kept = kept_selections(file, *whole);
  if (!kept) {
    complain(kept.error());
  }
  const std::scoped_lock lock(mutex_);
  selections_file_ = file;
  if (kept) {
    state_.selections = std::make_shared<const std::vector<MeshSelection>>(*std::move(kept));
  }
}

void MeshViewing::take_written(std::vector<fs::path> files) {
  const std::scoped_lock lock(mutex_);
  state_.written = std::move(files);
  state_.error.reset();
}

void MeshViewing::change_selections(const std::function<void(std::vector<MeshSelection>&)>& change) {
  std::shared_ptr<const Mesh> whole;
  std::vector<MeshSelection> selections;
  fs::path file;
  std::string name;
  {
    const std::scoped_lock lock(mutex_);
    whole = state_.mesh;
    selections = *state_.selections;
    file = selections_file_;
    name = state_.name.empty() ? "model.ply" : state_.name;
  }
  if (!whole || file.empty()) {
    return;
  }
  std::error_code error;
  if (const Status outside = check_outside_packages(file); !outside) {
    complain(outside.error());
    return;
  }
  fs::create_directories(file.parent_path(), error);  // what is wrong is said by the lock
  const Result<WritersTurn> turn = WritersTurn::take(folder_of(file));
  if (!turn) {
    complain(turn.error());
    return;
  }
  // Another program may have kept some meanwhile.
  if (Result<std::vector<MeshSelection>> there = kept_selections(file, *whole)) {
    selections = std::move(*there);
  }
  change(selections);
  if (const Status kept = keep_selections(file, name, *whole, selections); !kept) {
    complain(kept.error());
    return;
  }
  take_written({file});
  const std::scoped_lock lock(mutex_);
  state_.selections = std::make_shared<const std::vector<MeshSelection>>(std::move(selections));
}

void MeshViewing::keep_selection(MeshSelection selection) {
  ask(
      [this, selection = std::move(selection)] {
        change_selections([&](std::vector<MeshSelection>& all) { keep_under_free_name(selection, &all); });
      },
      AskedBy::kPersonForGood);
}

void MeshViewing::forget_selection(const std::string& name) {
  ask(
      [this, name] {
        change_selections([&](std::vector<MeshSelection>& all) {
          std::erase_if(all, [&](const MeshSelection& one) { return one.name == name; });
        });
      },
      AskedBy::kPersonForGood);
}

void MeshViewing::write_part(MeshSelection selection, const fs::path& file) {
  ask([this, selection = std::move(selection), file] {
    if (const std::shared_ptr<const Mesh> whole = mesh(); whole && fits(selection, *whole)) {
      Status written = check_outside_packages(file);
      if (written) {
        const Mesh part = part_of(*whole, selection);
        written =
            unmeasured_ ? write_ply_of_unknown_unit(file, part, label_) : write_mesh(file, part, label_);
      }
      if (!written) {
        complain(written.error());
        return;
      }
      take_written({file});
    }
  });
}

void MeshViewing::write_wedges_of(MeshSelection selection, const fs::path& file) {
  ask([this, selection = std::move(selection), file] {
    const ViewedMesh now = state();
    if (!now.mesh || !now.wedges || !fits(selection, *now.mesh)) {
      return;
    }
    const std::vector<Wedge> wedges = selected_wedges(*now.wedges, *now.mesh, selection);
    const Status outside = check_outside_packages(file);
    if (const Status written = outside ? write_file_atomically(file, wedge_table(wedges, label_)) : outside;
        !written) {
      complain(written.error());
      return;
    }
    take_written({file});
  });
}

void MeshViewing::analyse_part(MeshSelection selection, const fs::path& stem) {
  ask([this, selection = std::move(selection), stem] {
    ViewedMesh before = state();
    if (!before.mesh || !fits(selection, *before.mesh)) {
      return;
    }
    if (unmeasured_) {
      complain(*unmeasured_);
      return;
    }
    const auto part = std::make_shared<const Mesh>(part_of(*before.mesh, selection));
    fs::path mesh_file = stem;
    mesh_file += ".ply";
    fs::path wedges_file = stem;
    wedges_file += ".wedges.json";
    AnalysisOptions options;
    options.wedges.earlier.wedges = known_wedges_in(wedges_file);
    const Result<Analysis> analysis = analyze_mesh(*part, options, *job_);
    if (!analysis) {
      complain(analysis.error());
      return;
    }
    WedgeFile wedges = wedge_file(mesh_file.filename().string(), options, *analysis);
    wedges.label = label_;
    Status written = check_outside_packages(mesh_file);
    written = written ? write_mesh(mesh_file, *part, label_) : written;
    written = written ? write_wedges(wedges_file, wedges) : written;
    if (!written) {
      complain(written.error());
      return;
    }
    if (!before.is_part) {
      whole_options_ = analysis_options_;
      whole_wedges_file_ = wedges_file_;
      whole_in_session_ = in_session_;
      whole_foreign_wedges_ = foreign_wedges_;
    }
    std::vector<Error> doubts = before.mesh_doubts;  // it has the numbers of the whole
    if (foreign_wedges_) {
      std::erase_if(doubts, [&](const Error& one) { return one.line() == foreign_wedges_->line(); });
    }
    std::optional<ViewedMesh> whole;
    {
      const std::scoped_lock lock(mutex_);
      whole = before.is_part ? std::move(whole_) : std::optional(before);
      whole_selections_file_ = before.is_part ? whole_selections_file_ : selections_file_;
    }
    // A part keeps the frame of the whole: its obverse is where the tablet's is.
    take_mesh(part, before.tablet_from_model, mesh_file.filename().string());
    doubt_mesh(std::move(doubts));
    analysis_options_.wedges.earlier.wedges = known_wedges(wedges.wedges, wedges.former);
    take_wedges(std::move(wedges), analysis->fields.body_count());
    take_field(MeshField::kOpenness, analysis->fields.openness);
    take_field(MeshField::kMeanCurvature, analysis->fields.mean_curvature_per_mm);
    take_field(MeshField::kHeight, analysis->fields.height_mm);
    wedges_file_ = wedges_file;
    in_session_ = false;
    take_selections(selections_file_of(mesh_file));
    take_written({mesh_file, wedges_file});
    const std::scoped_lock lock(mutex_);
    state_.is_part = true;
    whole_ = std::move(whole);
  });
}

void MeshViewing::leave_part() {
  ask([this] {
    const std::scoped_lock lock(mutex_);
    if (whole_) {
      analysis_.reset();
      analysis_options_ = whole_options_;
      wedges_file_ = whole_wedges_file_;
      in_session_ = whole_in_session_;
      foreign_wedges_ = whole_foreign_wedges_;
      const std::uint64_t number = state_.number;
      state_ = *std::exchange(whole_, std::nullopt);
      state_.number = number + 1;
      forget_section();  // its places are no longer clicked
      state_.written.clear();
      selections_file_ = whole_selections_file_;
    }
  });
}

}  // namespace dubsar
