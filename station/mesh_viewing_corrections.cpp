// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The wedges of the mesh that is looked at: what is to be doubted in them, and what a person says of them.
#include <memory>
#include <utility>

#include "formats/corrections_json.h"
#include "formats/wedges_json.h"
#include "station/analysis_asked.h"
#include "station/correction_region.h"
#include "station/earlier_wedges.h"
#include "station/mesh_viewing.h"
#include "station/place_outside.h"
#include "station/wedge_doubts.h"

namespace dubsar {

namespace fs = std::filesystem;

void MeshViewing::take_wedges(WedgeFile found, std::size_t bodies) {
  std::vector<Error> doubts = doubts_of(found, {}, bodies);
  const std::scoped_lock lock(mutex_);
  state_.wedges = std::make_shared<const std::vector<Wedge>>(std::move(found.wedges));
  state_.doubts = std::move(doubts);
}

void MeshViewing::take_measured_wedges() {
  take_wedges(wedge_file({}, analysis_options_, *analysis_), analysis_->fields.body_count());
}

/// The wedges as they were measured, and corrected as they were: measured again when that was later.
void MeshViewing::take_corrections(const fs::path& wedges_file, bool in_session) {
  wedges_file_ = wedges_file;
  in_session_ = in_session;
  if (wedges_file_.empty()) {
    return;
  }
  const fs::path corrections_file = corrections_file_of(wedges_file_);
  Result<CorrectionFile> said = read_corrections(corrections_file);
  if (!said) {
    complain(said.error());
  }
  AnalysisAsked asked;
  asked.out = wedges_file_.string();
  take_known_options(asked, [](const char*) { return false; });
  analysis_options_ = options_of(asked, said ? std::move(said->corrections) : std::vector<WedgeCorrection>{});
  const std::size_t count = analysis_options_.wedges.corrections.size();
  {
    const std::scoped_lock lock(mutex_);
    state_.corrections = count;
  }
  std::error_code error;
  if (!fs::is_regular_file(wedges_file_, error)) {
    return;
  }
  Result<WedgeFile> known = read_wedges(wedges_file_);
  if (!known) {
    complain(known.error());
    return;
  }
  analysis_options_.wedges.exits = known->exits;  // what it holds, whatever a stamp of before says
  analysis_options_.wedges.earlier.wedges = known_wedges(known->wedges, known->former);
  const bool since =
      count > 0 && fs::last_write_time(corrections_file, error) > fs::last_write_time(wedges_file_, error);
  const bool is_old = since || count != known->corrections;
  take_wedges(*std::move(known));
  if (is_old && measure_all()) {
    take_measured_wedges();
  }
}

/// Everything that corrections rest on. False when it was stopped or cannot be.
bool MeshViewing::measure_all() {
  const std::shared_ptr<const Mesh> shown = mesh();
  if (!shown) {
    return false;
  }
  if (!analysis_) {
    Result<Analysis> analysis = analyze_mesh(*shown, analysis_options_, *job_);
    if (!analysis) {
      complain(analysis.error());
      return false;
    }
    analysis_ = std::make_unique<Analysis>(*std::move(analysis));
  }
  take_field(MeshField::kOpenness, analysis_->fields.openness);
  take_field(MeshField::kMeanCurvature, analysis_->fields.mean_curvature_per_mm);
  take_field(MeshField::kHeight, analysis_->fields.height_mm);
  return true;
}

void MeshViewing::make_corrections(std::vector<WedgeCorrection> corrections, bool must_make_last) {
  if (!measure_all()) {
    return;
  }
  const std::shared_ptr<const Mesh> shown = mesh();
  std::swap(analysis_options_.wedges.corrections, corrections);
  correct_analysis(*shown, analysis_options_, analysis_.get());
  const std::vector<LostCorrection> lost = analysis_->set.lost;
  const std::size_t count = analysis_options_.wedges.corrections.size();
  const bool refused = must_make_last && !lost.empty() && lost.back().index + 1 == count;
  const bool is_kept = !refused && !wedges_file_.empty();
  Status written = is_kept ? check_outside_packages(wedges_file_) : Status();
  if (is_kept && written) {
    const std::string name = state().name.empty() ? "model.ply" : state().name;
    const fs::path file = corrections_file_of(wedges_file_);
    const std::vector<WedgeCorrection>& now = analysis_options_.wedges.corrections;
    std::error_code error;
    fs::create_directories(wedges_file_.parent_path(), error);  // what is wrong is said by the writing
    written = replace_corrections(file, corrections, {name, now});
    if (written && !in_session_) {
      WedgeFile wedges = wedge_file(name, analysis_options_, *analysis_);
      wedges.label = label_;
      written = write_wedges(wedges_file_, wedges);
      if (!written) {
        (void)replace_corrections(file, now, {name, corrections});
      } else {  // an id that was told there is of no other wedge, also when this is taken back
        analysis_options_.wedges.earlier.wedges = known_wedges(analysis_->set.wedges, analysis_->set.former);
      }
    }
  }
  if (refused || !written) {  // all is as it was
    std::swap(analysis_options_.wedges.corrections, corrections);
    correct_analysis(*shown, analysis_options_, analysis_.get());
  }
  take_measured_wedges();
  if (!written) {
    complain(written.error());
  }
  const std::scoped_lock lock(mutex_);
  state_.corrections = analysis_options_.wedges.corrections.size();
  state_.not_made.clear();
  if (refused) {
    state_.not_made.push_back(lost.back().reason);
  } else {
    for (const LostCorrection& one : lost) {
      state_.not_made.push_back(one.reason);
    }
  }
}

void MeshViewing::correct(WedgeCorrection correction) {
  ask([this, correction = std::move(correction)] {
    std::vector<WedgeCorrection> all = analysis_options_.wedges.corrections;
    all.push_back(correction);
    make_corrections(std::move(all), true);
  });
}

void MeshViewing::correct_by_adding(MeshSelection selection) {
  ask([this, selection = std::move(selection)] {
    const std::shared_ptr<const Mesh> shown = mesh();
    if (shown && fits(selection, *shown)) {
      std::vector<WedgeCorrection> all = analysis_options_.wedges.corrections;
      all.push_back(addition_of(*shown, selection));
      make_corrections(std::move(all), true);
    }
  });
}

void MeshViewing::undo_correction() {
  ask([this] {
    std::vector<WedgeCorrection> all = analysis_options_.wedges.corrections;
    if (!all.empty()) {
      all.pop_back();
      make_corrections(std::move(all), false);
    }
  });
}

}  // namespace dubsar
