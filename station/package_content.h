// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/session_store.h"
#include "archive/provenance.h"
#include "archive/wedges_in_view.h"
#include "formats/file_label.h"
#include "formats/wedges_json.h"
#include "station/package.h"
#include "station/package_features.h"
#include "station/package_source.h"
#include "station/results.h"
#include "station/session_scans.h"
#include "station/tablet_record.h"

namespace dubsar {

/// A file of a package, or a row of files of one kind.
struct PackagedFile {
  std::string path;  ///< below the payload's folder
  std::string what;  ///< one line for people
};

/// A picture of a package that the manifest lists.
struct PackagedPicture {
  std::string path;   ///< below the payload's folder
  std::string label;  ///< "Obverse, clay"
  std::string media_type;
  int width = 0;
  int height = 0;
  double mm_per_px = 0;
  std::vector<WedgeOnPicture> wedges{};  ///< that it shows
};

/// What the writers of a package's parts share. Refers to what write_package() keeps alive.
struct PackageContent {
  std::filesystem::path root;  ///< the payload's folder
  const PackageSource& source;
  const SessionStore& store;
  PackageOptions options;
  PageFacts facts;
  TabletRecord tablet;
  std::string identifier;  ///< for people: "BM 12345"
  std::string stem;        ///< for file names: "BM_12345"
  std::string when;        ///< ISO 8601, one for the whole package
  std::string simulated;   ///< a sentence, where a program made the tablet up; empty of clay
  FileLabel label;         ///< what its meshes and scans say of themselves
  RigidTransform
      tablet_from_model;  ///< how the pictures lie: by the text where that is certain, else by the shape
  bool lies_by_text = false;
  std::optional<WedgeFile> wedges;
  bool wedges_are_kept = false;         ///< as the session has them; else measured for the package
  std::optional<PackageFields> fields;  ///< see need_fields()
  std::vector<PackagedFile> files;
  std::vector<PackagedPicture> pictures;
  std::vector<std::string> lacking;   ///< what is not in it and why, one sentence each
  std::vector<std::string> left_out;  ///< what lies in the session's folder and was not wanted, likewise
  JobContext& job;

  /// Files of who knows what scanner, not a scanner.
  [[nodiscard]] bool comes_from_files() const { return facts.device.starts_with("replay:"); }
  /// Scans that name different devices, or some of them none: `facts` knows that of the last one only.
  [[nodiscard]] bool comes_of_several_devices() const { return devices_of_scans(store).size() > 1; }
  [[nodiscard]] bool has(PackagePart part) const { return !options.without.contains(part); }
  [[nodiscard]] const Results& results() const { return source.results(); }
  [[nodiscard]] const Mesh& mesh() const { return source.results().mesh; }
  /// Makes the folder above `path` and returns the whole path.
  [[nodiscard]] Result<std::filesystem::path> place(const std::string& path) const;
  /// Writes a text and lists it.
  [[nodiscard]] Status text(const std::string& path, std::string_view content, std::string what);
  /// Works out `fields` unless they are there. Errors: kCancelled.
  [[nodiscard]] Status need_fields();
  void list(std::string path, std::string what) { files.push_back({std::move(path), std::move(what)}); }
};

/// What each step was done with (package_parameters.cpp). Thresholds are this
/// program's: what another version went by is told only where the session keeps it.
[[nodiscard]] std::vector<ProvenanceValue> registration_parameters(const PackageContent& content);
[[nodiscard]] std::vector<ProvenanceValue> verdict_parameters(const PackageContent& content);
[[nodiscard]] std::vector<ProvenanceValue> stitching_parameters(const PackageContent& content);
[[nodiscard]] std::vector<ProvenanceValue> analysis_parameters(const PackageContent& content);
/// Which program made what the session keeps; program_name() where that is not known.
[[nodiscard]] std::string keeper_of(const PackageContent& content);
/// Which program placed the scans, and which judged them (this one, where the session's verdict is not what
/// is packed); program_name() where that is not known.
[[nodiscard]] std::string placer_of(const PackageContent& content);
[[nodiscard]] std::string judge_of(const PackageContent& content);
/// Which program measured the wedges, as they say themselves. Only where there are wedges.
[[nodiscard]] std::string measurer_of(const PackageContent& content);
/// Where inner edges end, and what a person has corrected.
[[nodiscard]] std::string analysis_note(const WedgeFile& wedges);

/// What a conclusive verdict says, and how much of the tablet it says nothing of.
[[nodiscard]] std::string conclusive_words(const RedMap& map);
/// How the verdict is signed, and whether that holds: "signed by A. Reader, 2026-01-02T03:04:05Z: conclusive;
/// it holds", or that nobody signed.
[[nodiscard]] std::string signature_words(const PackageContent& content);

/// What a person said and selected in the viewer: in the session, and in a package.
inline constexpr const char* kCorrectionsOfSession = "analysis/wedges.corrections.json";
inline constexpr const char* kSelectionsOfSession = "analysis/selections.json";
inline constexpr const char* kPackedCorrections = "wedges/corrections.json";
inline constexpr const char* kPackedSelections = "wedges/selections.json";
/// A file of the session that is one of the two.
[[nodiscard]] bool is_by_hand(const std::string& name);
/// A file of the session's that is made of its scans: in mesh/, analysis/ or export/.
[[nodiscard]] bool is_derived(const std::string& name);

// The parts, in the order of the work. Each lists what it wrote. Errors: kStorage, kCancelled, and those of
// the stages.
[[nodiscard]] Status add_scans(PackageContent& content);
[[nodiscard]] Status add_unfinished(PackageContent& content);
/// Names the session's folders that cannot be read.
[[nodiscard]] Status add_unreadable(PackageContent& content);
[[nodiscard]] Status add_records(PackageContent& content);
[[nodiscard]] Status add_model(PackageContent& content);
[[nodiscard]] Status add_kept(PackageContent& content);
/// What a person said of the wedges and selected on the model.
[[nodiscard]] Status add_by_hand(PackageContent& content);
/// Names what lies in the session and is not packed.
[[nodiscard]] Status add_left_out(PackageContent& content);
[[nodiscard]] Status add_wedges(PackageContent& content);
[[nodiscard]] Status add_features(PackageContent& content);
[[nodiscard]] Status add_renderings(PackageContent& content);
[[nodiscard]] Status add_reports(PackageContent& content);
[[nodiscard]] Status add_linked_data(PackageContent& content);
/// Last: it lists the others.
[[nodiscard]] Status add_readme(PackageContent& content);

/// The documents on the formats that a package carries along: file name and text.
struct FormatText {
  const char* name;
  const char* text;
};
[[nodiscard]] const std::vector<FormatText>& format_texts();

}  // namespace dubsar
