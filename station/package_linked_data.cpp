// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a package tells other programs: how it came about, and what there is to show.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <utility>

#include "archive/canvas_annotations.h"
#include "archive/iiif_manifest.h"
#include "archive/provenance.h"
#include "core/utf8.h"
#include "formats/atomic_file.h"
#include "formats/draco_mesh.h"
#include "formats/files_below.h"
#include "station/package_content.h"
#include "station/results.h"

namespace dubsar {

namespace {

bool is_listed(const PackageContent& content, const std::string& file) {
  return std::ranges::find(content.files, file, &PackagedFile::path) != content.files.end();
}

std::string fate_of(const StoredScan& scan, const ScanPose* pose) {
  if (scan.damaged) {
    return "damaged in the session: its samples are lost";
  }
  if (scan.dropped) {
    return scan.note.empty() ? "taken out by the operator" : "taken out: " + scan.note;
  }
  if (pose == nullptr) {
    return "not placed";
  }
  return pose->reason.empty() ? to_string(pose->status)
                              : std::string(to_string(pose->status)) + ": " + pose->reason;
}

ProvenanceScan scan_of(const PackageContent& content, const StoredScan& scan) {
  const auto& poses = content.results().poses;
  const auto at = std::ranges::find(poses, scan.id, &ScanPose::id);
  const ScanPose* pose = scan.dropped || at == poses.end() ? nullptr : &*at;
  ProvenanceScan out;
  out.id = scan.id;
  const auto entry = std::ranges::find(content.facts.scans, scan.id, &ScanEntry::id);
  if (entry != content.facts.scans.end()) {
    out.when = entry->when;
    out.stored_only = !entry->by_device;
  }
  out.file = scan.damaged ? std::string() : fmt::format("scans/grids/{:03}.grid", scan.id);
  out.device = one_line(scan.device);
  out.note = fate_of(scan, pose);
  out.in_model = pose != nullptr && pose->status == PoseStatus::kRegistered && !scan.damaged;
  out.values = {{"samples", static_cast<double>(scan.samples), ""},
                {"lateral spacing", scan.spacing_mm, "mm"}};
  if (out.in_model) {
    if (was_compared(*pose)) {
      out.values.push_back({"RMS to the overlapping scans", pose->rms_mm, "mm"});
    }
    out.values.push_back({"predicted error of its place", pose->sigma_mm, "mm"});
    out.values.push_back({"overlap with the other scans", pose->overlap, ""});
  }
  return out;
}

/// The files that lie there by now, below the payload's folder, in order.
Result<std::vector<std::string>> payload_of(const PackageContent& content) {
  const Result<std::vector<std::filesystem::path>> files = files_below(content.root);
  if (!files) {
    return std::unexpected(files.error());
  }
  std::vector<std::string> paths;
  paths.reserve(files->size());
  for (const std::filesystem::path& file : *files) {
    paths.push_back(file.lexically_relative(content.root).generic_string());
  }
  return paths;
}

/// Those in a folder.
std::vector<std::string> files_of(const std::vector<std::string>& payload, std::string_view folder) {
  std::vector<std::string> files;
  std::ranges::copy_if(payload, std::back_inserter(files),
                       [&](const std::string& path) { return path.starts_with(folder); });
  return files;
}

/// What a step made is what lies in its folder: so no file is forgotten that another part came to write.
void add_step(const std::vector<std::string>& payload, std::string_view folder, ProvenanceStep step,
              ProvenanceInput& input) {
  step.made = files_of(payload, folder);
  std::erase(step.made, kPackedCorrections);  // a person's
  std::erase(step.made, kPackedSelections);
  if (!step.made.empty()) {
    input.steps.push_back(std::move(step));
  }
}

void add_steps(const PackageContent& content, const std::vector<std::string>& payload,
               ProvenanceInput& input) {
  ProvenanceStep registration{"registration",       "Registration of the scans",      {},
                              {"scans/poses.json"}, registration_parameters(content), {},
                              placer_of(content)};
  double worst_rms_mm = 0;
  double worst_sigma_mm = 0;
  bool any_compared = false;
  for (const ScanPose& pose : content.results().poses) {
    if (pose.status == PoseStatus::kRegistered) {
      worst_rms_mm = std::max(worst_rms_mm, pose.rms_mm);
      worst_sigma_mm = std::max(worst_sigma_mm, pose.sigma_mm);
      any_compared = any_compared || was_compared(pose);
    }
  }
  for (const ProvenanceScan& scan : input.scans) {
    if (scan.in_model) {
      registration.from.push_back(scan.file);
    }
  }
  registration.note = content.source.behind();
  if (any_compared) {
    registration.results = {{"worst RMS between overlapping scans", worst_rms_mm, "mm"},
                            {"worst predicted error of a place", worst_sigma_mm, "mm"}};
  }
  ProvenanceStep verdict{"verdict",
                         "What is sampled densely enough",
                         registration.from,
                         {"verdict/red_map.json", "verdict/checklist.json"},
                         verdict_parameters(content),
                         {{"conclusive", content.results().red_map.conclusive ? 1.0 : 0.0, ""}},
                         judge_of(content)};
  verdict.from.emplace_back("scans/poses.json");
  const std::string model = "model/" + content.stem + ".ply";
  std::vector<ProvenanceStep> steps{std::move(registration), verdict};
  if (!content.mesh().faces.empty()) {
    // A mesh that another version stitched is never taken (stored_mesh()).
    steps.push_back({"stitching",
                     "Stitching into one surface",
                     verdict.from,
                     {model},
                     stitching_parameters(content),
                     {{"vertices", static_cast<double>(content.mesh().positions.size()), ""},
                      {"triangles", static_cast<double>(content.mesh().faces.size()), ""}}});
    std::vector<std::string> forms = files_of(payload, "model/");
    std::erase(forms, model);
    std::vector<ProvenanceValue> rounding;
    if (is_listed(content, "model/" + content.stem + ".draco.glb")) {
      rounding = {{"step of the positions in the compressed form", draco_step_mm(content.mesh()), "mm"},
                  {"largest turn of a normal in the compressed form", kDracoNormalError_deg, "deg"}};
    }
    steps.push_back(
        {"conversion", "Other forms of the same surface", {model}, forms, std::move(rounding), {}});
  }
  input.steps = std::move(steps);
  std::vector<std::string> grids = files_of(payload, "scans/grids/");
  add_step(payload, "scans/ply/", {"unfolding", "The scans as ordered PLY", grids, {}, {}, {}}, input);
  const bool corrected = std::ranges::find(payload, kPackedCorrections) != payload.end();
  if (content.wedges) {
    add_step(
        payload, "wedges/",
        {"analysis",
         "Measurement of the wedges",
         corrected ? std::vector<std::string>{model, kPackedCorrections} : std::vector<std::string>{model},
         {},
         analysis_parameters(content),
         {{"wedges", static_cast<double>(content.wedges->wedges.size()), ""},
          {"hollows rejected", static_cast<double>(content.wedges->rejected.size()), ""}},
         measurer_of(content),
         analysis_note(*content.wedges)},
        input);
  }
  add_step(payload, "features/", {"features", "Values by vertex", {model}, {}, {}, {}}, input);
  add_step(payload, "pictures/", {"drawing", "Pictures drawn from the surface", {model}, {}, {}, {}}, input);
  std::vector<std::string> told = verdict.made;
  told.emplace_back("scans/poses.json");
  if (!content.mesh().faces.empty()) {
    told.push_back(model);
  }
  add_step(payload, "report/", {"report", "Pages for people", std::move(told), {}, {}, {}}, input);
  // What the session wrote down while it was scanned, and what says what lies here.
  ProvenanceStep packing{"packing", "Records of the session, and lists", std::move(grids), {}, {}, {}};
  for (const char* folder : {"session/", "scans/unfinished/", "kept/", "iiif/annotations/"}) {
    std::ranges::copy(files_of(payload, folder), std::back_inserter(packing.made));
  }
  for (const char* by_hand : {kPackedCorrections, kPackedSelections}) {
    std::ranges::copy(files_of(payload, by_hand), std::back_inserter(packing.made));
  }
  packing.made.emplace_back("scans/scans.json");
  packing.made.emplace_back("README.txt");
  if (!content.pictures.empty()) {
    packing.made.emplace_back("iiif/manifest.json");
  }
  input.steps.push_back(std::move(packing));
}

/// The latest sign-off: who, when, what was signed, and whether it holds.
void add_signature(const PackageContent& content, ProvenanceInput& input) {
  const auto& checked = content.results().checklist.sign_off;
  if (!checked) {
    return;
  }
  const SignOff& made = checked->sign_off;
  ProvenanceSignature signature{made.name, made.role, made.when, signature_words(content), {}};
  for (const char* what : {"red_map", "checklist"}) {
    const std::string file = fmt::format("session/signed_{}_{}.json", made.number, what);
    if (is_listed(content, file)) {
      signature.of.push_back(file);
    }
  }
  input.signatures.push_back(std::move(signature));
}

Status add_provenance(PackageContent& content) {
  const Result<std::vector<StoredScan>> scans = content.store.scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  const Checklist& list = content.results().checklist;
  ProvenanceInput input;
  input.base_url = content.options.base_url;
  input.identifier = content.identifier;
  input.museum_number = content.tablet.museum_number;
  input.cdli = content.tablet.cdli;
  input.collection = content.tablet.collection;
  input.tablet_note = content.simulated;
  input.operator_name = content.tablet.operator_name;
  input.rights = content.tablet.rights;
  input.device = content.facts.device;
  input.program = program_name();
  input.when = content.when;
  input.calibration = list.calibration;
  if (list.calibration_age_days) {
    input.calibration_values.push_back({"age when scanning began", *list.calibration_age_days, "day"});
  }
  if (list.calibration_check) {
    input.calibration +=
        " Checked on " + list.calibration_check->artefact + ", " + list.calibration_check->when + ".";
    input.calibration_values.push_back(
        {"largest deviation from the certificate", list.calibration_check->error_mm, "mm"});
  }
  for (const StoredScan& scan : *scans) {
    input.scans.push_back(scan_of(content, scan));
  }
  const Result<std::vector<std::string>> payload = payload_of(content);
  if (!payload) {
    return std::unexpected(payload.error());
  }
  add_steps(content, *payload, input);
  add_signature(content, input);
  return content.text(
      "provenance.jsonld", provenance_jsonld(input),
      "how every file came about (but for formats/): device, calibration, every scan, every step with its "
      "errors "
      "(JSON-LD, terms of CIDOC CRM and CRMdig)");
}

std::string annotations_file(std::size_t picture) {
  return fmt::format("iiif/annotations/{}.json", picture + 1);
}

/// The wedges on the canvases that show any.
Status add_canvas_annotations(PackageContent& content) {
  bool any = false;
  for (std::size_t k = 0; k < content.pictures.size(); ++k) {
    const PackagedPicture& picture = content.pictures[k];
    if (picture.wedges.empty()) {
      continue;
    }
    any = true;
    const Result<std::filesystem::path> file = content.place(annotations_file(k));
    if (!file) {
      return std::unexpected(file.error());
    }
    const std::string page =
        canvas_annotations(content.wedges->wedges, picture.wedges,
                           {canvas_id(content.options.base_url, k), picture.width, picture.height},
                           {.base_url = content.options.base_url,
                            .page = annotations_file(k),
                            .model = {},
                            .identifier = content.identifier,
                            .program = program_name(),
                            .when = content.when,
                            .rights = content.tablet.rights,
                            .simulated = content.simulated});
    if (const Status written = write_file_atomically(*file, page); !written) {
      return written;
    }
  }
  if (any) {
    content.list("iiif/annotations/",
                 "the wedges on the pictures of the manifest that show them, one page for each: the triangle "
                 "of a wedge's outer edges, in pixels (IIIF Presentation 3.0)");
  }
  return {};
}

Status add_manifest(PackageContent& content) {
  ManifestInput input;
  input.base_url = content.options.base_url;
  input.label = content.identifier;
  input.summary = content.simulated.empty()
                      ? "Pictures of the tablet, drawn to scale from its measured surface"
                      : "Pictures, drawn to scale. " + content.simulated;
  input.metadata = {{"Simulated", content.simulated},       {"Museum number", content.tablet.museum_number},
                    {"CDLI number", content.tablet.cdli},   {"Collection", content.tablet.collection},
                    {"Scanned with", content.facts.device}, {"Drawn by", program_name()}};
  input.rights = content.tablet.rights;
  for (std::size_t k = 0; k < content.pictures.size(); ++k) {
    const PackagedPicture& p = content.pictures[k];
    input.pictures.push_back({p.path, p.label, p.media_type, p.width, p.height, p.mm_per_px,
                              p.wedges.empty() ? std::string() : annotations_file(k)});
  }
  const std::string model = "model/" + content.stem;
  for (const auto& [file, label] : {std::pair{model + ".glb", "The surface"},
                                    std::pair{model + ".draco.glb", "The surface, compressed (Draco)"}}) {
    if (is_listed(content, file)) {  // not where the mesh is larger than that format can hold
      input.rendering.push_back({file, label, "Model", "model/gltf-binary"});
    }
  }
  input.rendering.push_back({"report/report.html", "The report", "Text", "text/html"});
  input.see_also = {{model + ".ply", "The surface, with all values by vertex", "Model", "model/ply"},
                    {"provenance.jsonld", "How it came about", "Dataset", "application/ld+json"}};
  if (content.wedges) {
    input.see_also.push_back(
        {"wedges/annotations.json", "The wedges as annotations", "Dataset", "application/ld+json"});
  }
  return content.text("iiif/manifest.json", iiif_manifest(input),
                      "what there is to show, for viewers (IIIF Presentation 3.0)");
}

}  // namespace

Status add_linked_data(PackageContent& content) {
  for (const auto add : {add_canvas_annotations, add_provenance}) {
    if (const Status added = add(content); !added) {
      return added;
    }
  }
  return content.pictures.empty() ? Status{} : add_manifest(content);
}

}  // namespace dubsar
