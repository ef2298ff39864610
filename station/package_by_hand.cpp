// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a person said of the wedges and selected on the model, as the session keeps it: nobody can make it
// anew.

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "formats/atomic_file.h"
#include "formats/corrections_json.h"
#include "formats/json_node.h"
#include "formats/selections_json.h"
#include "station/package_content.h"
#include "station/selected_mesh.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// A file of the session as it goes along to the bit, damaged or not.
struct ByHand {
  const char* in_session;
  const char* packed;
  const char* page;     ///< of formats/
  const char* missing;  ///< what the package lacks where it is damaged
};
constexpr ByHand kCorrectionsByHand = {
    kCorrectionsOfSession, kPackedCorrections, "corrections",
    "what a person said of the wedges is not in wedges/, which are as the program found them"};
constexpr ByHand kSelectionsByHand = {kSelectionsOfSession, kPackedSelections, "selections",
                                      "the parts of the model that a person selected are not in wedges/"};

/// Nothing where there is none, or none can be read, which is told.
std::optional<std::string> bytes_of(PackageContent& content, const ByHand& file) {
  std::error_code unknown;
  const fs::path path = content.store.folder() / file.in_session;
  if (!fs::exists(fs::symlink_status(path, unknown))) {
    return std::nullopt;  // where its folder cannot be read that is told of the folder
  }
  Result<std::string> bytes = read_whole_file(path, kMaxJsonBytes);
  if (!bytes) {
    content.lacking.push_back(
        fmt::format("{} of the session cannot be read ({}): {}, and the file is not here.", file.in_session,
                    bytes.error().what, file.missing));
    return std::nullopt;
  }
  return std::move(*bytes);
}

Status keep_damaged(PackageContent& content, const ByHand& file, const std::string& bytes, const Error& why) {
  const std::string kept = std::string("kept/") + file.in_session;
  content.lacking.push_back(
      fmt::format("{} is damaged in the session ({}): {}. The file is here as it lies there: {}.",
                  file.in_session, why.what, file.missing, kept));
  return content.text(kept, bytes,
                      fmt::format("as it lies in the session, damaged: formats/{}.txt", file.page));
}

Status add_corrections(PackageContent& content) {
  const std::optional<std::string> bytes = bytes_of(content, kCorrectionsByHand);
  if (!bytes) {
    return {};
  }
  const Result<CorrectionFile> file = parse_corrections(*bytes, kCorrectionsOfSession);
  if (!file) {
    return keep_damaged(content, kCorrectionsByHand, *bytes, file.error());
  }
  const std::size_t count = file->corrections.size();
  const bool made = content.wedges && has_corrections(*content.wedges, file->corrections);
  return content.text(
      kPackedCorrections, *bytes,
      fmt::format(
          "what a person said of the wedges, as the session keeps it: {} correction{}{}: "
          "formats/corrections.txt",
          count, count == 1 ? "" : "s",
          made ? fmt::format(", {} of which could be made", count - content.wedges->lost.size()) : ""));
}

/// The mesh in the package whose faces and vertices the selections mean; empty where it is none of them. That
/// of the session goes along for them where it is the one.
Result<std::string> mesh_of(PackageContent& content, const SelectionFile& file) {
  if (file.surface_xxh128 == surface_digest(content.mesh())) {
    return "model/" + content.stem + ".ply";
  }
  const std::vector<std::string> own = meshes_of_selections(content.store.folder(), file.surface_xxh128);
  if (own.empty()) {
    return std::string();
  }
  const std::string kept = "kept/" + own.front();
  std::error_code unknown;
  if (!fs::exists(content.root / kept, unknown)) {
    const Result<std::string> bytes = read_whole_file(content.store.folder() / own.front());
    const Status written =
        bytes ? content.text(kept, *bytes,
                             "the mesh as the session keeps it, made of other scans or places "
                             "than those that are here: the one that wedges/selections.json "
                             "is of: formats/mesh.txt")
              : Status(std::unexpected(bytes.error()));
    if (!written) {
      return std::unexpected(written.error());
    }
  }
  return kept;
}

Status add_selections(PackageContent& content) {
  const std::optional<std::string> bytes = bytes_of(content, kSelectionsByHand);
  if (!bytes) {
    return {};
  }
  const Result<SelectionFile> file = parse_selections(*bytes, kSelectionsOfSession);
  if (!file) {
    return keep_damaged(content, kSelectionsByHand, *bytes, file.error());
  }
  const Result<std::string> mesh = mesh_of(content, *file);
  if (!mesh) {
    return std::unexpected(mesh.error());
  }
  std::string names;
  for (const MeshSelection& one : file->selections) {
    names += (names.empty() ? "" : ", ") + one.name;
  }
  return content.text(
      kPackedSelections, *bytes,
      fmt::format("the parts of the model that a person selected, as the session keeps them ({}): {}: "
                  "formats/selections.txt",
                  names.empty() ? "none" : names,
                  mesh->empty()
                      ? "of a surface that is not here, so that their numbers tell nothing of this one"
                      : "faces and vertices by their numbers in " + *mesh));
}

/// Meshes whose selections were put aside since: those lie in kept/, too.
Status add_selected_meshes(PackageContent& content) {
  for (const std::string& name : kept_selected_meshes(content.store.folder())) {
    std::error_code unknown;
    const std::string kept = "kept/" + name;
    const auto& whole = content.source.found().whole;
    if (fs::exists(content.root / kept, unknown) || std::ranges::find(whole, name) == whole.end()) {
      continue;
    }
    const Result<std::string> bytes = read_whole_file(content.store.folder() / name);
    const Status written =
        bytes ? content.text(kept, *bytes,
                             "a mesh that earlier selections of a person are of: formats/mesh.txt")
              : Status(std::unexpected(bytes.error()));
    if (!written) {
      return written;
    }
  }
  return {};
}

}  // namespace

bool is_by_hand(const std::string& name) {
  return name == kCorrectionsOfSession || name == kSelectionsOfSession;
}

Status add_by_hand(PackageContent& content) {
  for (const auto& add : {add_corrections, add_selections, add_selected_meshes}) {
    if (const Status added = add(content); !added) {
      return added;
    }
  }
  return {};
}

}  // namespace dubsar
