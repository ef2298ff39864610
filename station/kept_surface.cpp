// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/kept_surface.h"

#include <algorithm>

#include "archive/wedge_drawing.h"
#include "formats/atomic_file.h"
#include "formats/json_text.h"
#include "formats/mesh_io.h"
#include "station/results.h"
#include "station/selected_mesh.h"
#include "station/session_name.h"
#include "station/session_pages.h"
#include "station/tablet_label.h"

namespace dubsar {

namespace fs = std::filesystem;

namespace {

constexpr const char* kWedges = "analysis/wedges.json";
constexpr const char* kMeasured = "the wedges were measured anew";
constexpr const char* kRun = "run";  // as results.cpp keeps it

/// Those of this mesh; nothing where it has no surface to look at.
Result<std::optional<SessionWedges>> wedges_of(SessionStore& store, const Mesh& mesh, JobContext& job) {
  if (const std::optional<WedgeFile> kept = stored_wedges(store, mesh, job)) {
    return counts_of(*kept, store.folder() / kWedges);
  }
  const Status taken = take_pages_back_once(store, kMeasured, kPlan);
  return taken ? keep_wedges(store, mesh, job) : std::unexpected(taken.error());
}

}  // namespace

Result<Deliverables> keep_all_anew(SessionStore& store, const PlannedAgain& planned, JobContext& job) {
  const Results& results = planned.results;
  PageFacts facts = page_facts_of(store);
  std::optional<SessionWedges> wedges;
  if (!results.mesh.faces.empty()) {  // else the mesh of before stays, and with it what was measured on it
    Result<std::optional<SessionWedges>> kept = wedges_of(store, results.mesh, job);
    if (!kept) {
      return std::unexpected(kept.error());
    }
    wedges = std::move(*kept);
  }
  if (wedges) {
    tell_wedges(facts, *wedges);
    if (Status noted = keep_wedges_word(store, facts.wedges); !noted) {
      return std::unexpected(noted.error());
    }
  } else {
    tell_kept_wedges(facts, store, results.mesh, job);
  }
  Result<Deliverables> files = keep_deliverables(store, report_input(results, *planned.stage, facts), job);
  if (files && wedges) {
    files->wedges = wedges->json;
  }
  return files;
}

Result<bool> make_wedges_anew(SessionStore& store, const std::vector<std::string>& names, JobContext& job) {
  const auto wanted = [&](const std::string& name) { return std::ranges::find(names, name) != names.end(); };
  const Result<Mesh> mesh = read_mesh(store.folder() / kSessionMesh);
  if (!mesh) {
    return std::unexpected(mesh.error());
  }
  if (wanted(kWedges)) {
    const bool same_as_before = kept_wedges(store, *mesh) == KeptWedges::kAsMeasuredNow;
    const auto wedges = keep_wedges(store, *mesh, job);
    if (!wedges || !*wedges) {
      return wedges ? Result<bool>(false) : std::unexpected(wedges.error());
    }
    const std::string said = page_facts_of(store).wedges;
    const std::string now = wedge_sentence(**wedges);
    if (said.empty() || (said == now && same_as_before)) {
      return false;
    }
    const Status taken = take_pages_back_once(store, kMeasured, kPlan);
    const Status told = taken ? keep_wedges_word(store, now) : taken;
    return told ? Result<bool>(true) : std::unexpected(told.error());
  }
  const Result<WedgeFile> file = read_wedges(store.folder() / kWedges);
  if (!file || !file->text_from_model) {
    return file ? Result<bool>(false) : std::unexpected(file.error());
  }
  const PictureWords words = picture_words(file->label, session_name(store.folder()));
  for (const WedgeDrawing& drawing :
       wedge_drawings(store.analysis_folder(), file->wedges, *file->text_from_model, words, &*mesh)) {
    const std::string name = "analysis/" + drawing.name;
    const auto draw = [&](const fs::path& to) { return write_file_atomically(to, drawing.svg); };
    if (const Status kept = wanted(name) ? store.replace_file(name, draw) : Status(); !kept) {
      return std::unexpected(kept.error());
    }
  }
  return false;
}

void tell_wedges(PageFacts& facts, const SessionWedges& wedges) {
  facts.wedges = wedge_sentence(wedges);
  facts.wedge_profiles = wedges.profiles;
}

void tell_kept_wedges(PageFacts& facts, const SessionStore& store, const Mesh& mesh, const JobContext& job) {
  if (facts.wedges.empty()) {
    return;
  }
  if (const std::optional<WedgeFile> kept = stored_wedges(store, mesh, job)) {
    tell_wedges(facts, counts_of(*kept, store.folder() / kWedges));
    return;
  }
  facts.wedge_profiles.clear();
  if (kept_wedges(store, mesh) != KeptWedges::kOfAnotherSurface) {
    facts.wedges =
        "They were not measured anew: those in analysis/wedges.json are of this mesh, but were measured or "
        "corrected in another way than now.";
  } else {
    facts.wedges =
        "They were not measured anew: those in analysis/wedges.json are of the mesh as it was before.";
  }
}

Status keep_wedges_word(SessionStore& store, const std::string& sentence) {
  const auto text = store.load_document(kRun);
  if (!text) {
    return std::unexpected(text.error());
  }
  OrderedJson run = OrderedJson::parse(text->value_or(""), nullptr, false);
  if (!run.is_object()) {
    return {};
  }
  run["wedges"] = sentence;
  return store.save_document(kRun, text_of(run));
}

}  // namespace dubsar
