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
#include "station/wedges_beside.h"
#include "station/wedges_on_mesh.h"

namespace dubsar {

namespace fs = std::filesystem;

namespace {

/// Why corrections were not made.
std::vector<std::string> reasons_of(const Analysis& analysis) {
  std::vector<std::string> out;
  for (const LostCorrection& one : analysis.set.lost) {
    out.push_back(one.reason);
  }
  return out;
}

bool same(const WedgeCorrection& a, const WedgeCorrection& b) {
  return corrections_to_json({{}, {a}}) == corrections_to_json({{}, {b}});
}

}  // namespace

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
  std::error_code error;
  std::optional<Result<WedgeFile>> known;
  if (fs::is_regular_file(wedges_file_, error)) {
    known = read_wedges(wedges_file_);
  }
  if (known && *known) {
    foreign_wedges_ = of_another_mesh((*known)->wedges, *mesh(), wedges_file_.filename().string());
  }
  if (foreign_wedges_) {  // and what was said of them
    doubt_mesh({*foreign_wedges_});
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
  if (!known) {
    if (count > 0 && !in_session_ && measure_all()) {  // noted, and stopped before any were written
      take_measured_wedges();
      finish_corrections();
    }
    return;
  }
  if (!*known) {
    complain(known->error());
    return;
  }
  WedgeFile& file = **known;
  analysis_options_.wedges.exits = file.exits;  // what it holds, whatever a stamp of before says
  analysis_options_.wedges.earlier.wedges = known_wedges(file.wedges, file.former);
  const bool since =
      count > 0 && fs::last_write_time(corrections_file, error) > fs::last_write_time(wedges_file_, error);
  const bool is_old = since || !has_corrections(file, analysis_options_.wedges.corrections);
  take_wedges(std::move(file));
  if (is_old && measure_all()) {
    take_measured_wedges();
    finish_corrections();
  }
}

/// Writes the measured wedges where their file does not have what is noted, of a correction that was stopped
/// or killed. Without a note that can be read nothing is known to be unfinished.
void MeshViewing::finish_corrections() {
  const fs::path note = corrections_file_of(wedges_file_);
  std::error_code error;
  if (wedges_file_.empty() || in_session_ || !fs::is_regular_file(note, error)) {
    return;
  }
  const Result<CorrectionFile> said = read_corrections(note);
  const std::vector<WedgeCorrection>& now = analysis_options_.wedges.corrections;
  bool is_made = now.empty();
  if (fs::is_regular_file(wedges_file_, error)) {
    const Result<WedgeFile> known = read_wedges(wedges_file_);
    if (!known || !(known->mesh.empty() || are_of(*known, state().name))) {
      return;
    }
    is_made = has_corrections(*known, now);
  }
  if (!said || corrections_digest(said->corrections) != corrections_digest(now) || is_made ||
      !check_outside_packages(wedges_file_)) {
    return;
  }
  if (const Status written = write_corrected(); !written) {
    complain(written.error());
  }
  say_corrected(reasons_of(*analysis_));
}

/// Everything that corrections rest on. False when it was stopped or cannot be.
bool MeshViewing::measure_all() {
  const std::shared_ptr<const Mesh> shown = mesh();
  if (!shown) {
    return false;
  }
  if (unmeasured_) {
    complain(*unmeasured_);
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

/// What a person says is there before it is measured, which takes long and may be stopped. Nothing where the
/// mesh has no place for it.
Status MeshViewing::note(const std::vector<WedgeCorrection>& known,
                         const std::vector<WedgeCorrection>& now) const {
  if (wedges_file_.empty()) {
    return {};
  }
  if (Status outside = check_outside_packages(wedges_file_); !outside) {
    return outside;
  }
  std::error_code error;
  fs::create_directories(wedges_file_.parent_path(), error);  // what is wrong is said by the writing
  const std::string name = state().name.empty() ? "model.ply" : state().name;
  return replace_corrections(corrections_file_of(wedges_file_), known, {name, now});
}

Status MeshViewing::write_corrected() {
  if (wedges_file_.empty() || in_session_) {
    return {};
  }
  WedgeFile wedges =
      wedge_file(state().name.empty() ? "model.ply" : state().name, analysis_options_, *analysis_);
  wedges.label = label_;
  if (!state().is_part) {  // whose own file says millimetres
    wedges.unit_assumed = unit_assumed_;
  }
  Status written = write_wedges(wedges_file_, wedges);
  if (written) {  // an id that was told there is of no other wedge, also when this is taken back
    analysis_options_.wedges.earlier.wedges = known_wedges(analysis_->set.wedges, analysis_->set.former);
  }
  return written;
}

void MeshViewing::say_corrected(std::vector<std::string> not_made) {
  const std::scoped_lock lock(mutex_);
  state_.corrections = analysis_options_.wedges.corrections.size();
  state_.not_made = std::move(not_made);
}

void MeshViewing::make_corrections(std::vector<WedgeCorrection> corrections, bool must_make_last) {
  if (foreign_wedges_) {  // theirs would be written over
    complain(*foreign_wedges_);
    return;
  }
  const std::shared_ptr<const Mesh> shown = mesh();
  if (!shown) {
    return;
  }
  std::vector<WedgeCorrection>& made = analysis_options_.wedges.corrections;
  const std::vector<WedgeCorrection> before = made;
  if (const Status noted = note(before, corrections); !noted) {
    complain(noted.error());
    say_corrected({});
    return;
  }
  if (!measure_all()) {
    if (job_->cancelled()) {
      made = std::move(corrections);
      say_corrected({"stopped: it is noted, and made with the next one or when the mesh is opened again"});
    } else if (const Status back = note(corrections, before); !back) {
      complain(back.error());
    }
    return;
  }
  made = corrections;
  correct_analysis(*shown, analysis_options_, analysis_.get());
  std::vector<std::string> not_made = reasons_of(*analysis_);
  const std::vector<LostCorrection>& lost = analysis_->set.lost;
  const bool refused = must_make_last && !lost.empty() && lost.back().index + 1 == made.size();
  Status written = refused ? Status() : write_corrected();
  if (refused || !written) {  // all is as it was
    if (refused) {
      not_made = {not_made.back()};
    }
    const Status back = note(corrections, before);
    written = written ? back : written;
    made = before;
    correct_analysis(*shown, analysis_options_, analysis_.get());
  }
  take_measured_wedges();
  if (!written) {
    complain(written.error());
  } else if (refused) {
    finish_corrections();  // of one that was stopped before this one
  }
  say_corrected(std::move(not_made));
}

/// All that was said, with this one.
std::vector<WedgeCorrection> MeshViewing::with_next(WedgeCorrection correction) const {
  std::vector<WedgeCorrection> all = analysis_options_.wedges.corrections;
  // Where it was noted before and stopped then, what is missing is the rest.
  if (analysis_ || all.empty() || !same(all.back(), correction)) {
    all.push_back(std::move(correction));
  }
  return all;
}

void MeshViewing::correct(WedgeCorrection correction) {
  ask([this, correction = std::move(correction)] { make_corrections(with_next(correction), true); },
      AskedBy::kPersonForGood);
}

void MeshViewing::correct_by_adding(MeshSelection selection) {
  ask(
      [this, selection = std::move(selection)] {
        const std::shared_ptr<const Mesh> shown = mesh();
        if (shown && fits(selection, *shown)) {
          make_corrections(with_next(addition_of(*shown, selection)), true);
        }
      },
      AskedBy::kPersonForGood);
}

void MeshViewing::undo_correction() {
  ask(
      [this] {
        std::vector<WedgeCorrection> all = analysis_options_.wedges.corrections;
        if (!all.empty()) {
          all.pop_back();
          make_corrections(std::move(all), false);
        }
      },
      AskedBy::kPersonForGood);
}

}  // namespace dubsar
