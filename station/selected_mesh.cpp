// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/selected_mesh.h"

#include <fmt/format.h>

#include <cstdio>
#include <optional>
#include <set>
#include <system_error>

#include "core/log.h"
#include "formats/atomic_file.h"
#include "formats/mesh_io.h"
#include "formats/selections_json.h"

namespace dubsar {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSelections = "analysis/selections.json";

std::string kept_name(int n) {
  return fmt::format("mesh/model.of-selections-{}.ply", n);
}

bool is_there(const fs::path& file) {
  std::error_code unknown;
  return fs::exists(fs::symlink_status(file, unknown));
}

/// Those that are there, rising. A damaged one may have been put aside from among them.
std::set<int> kept_numbers(const fs::path& session) {
  std::set<int> numbers;
  std::error_code unreadable;
  for (const fs::directory_entry& entry : fs::directory_iterator(session / "mesh", unreadable)) {
    int n = 0;
    const std::string name = "mesh/" + entry.path().filename().string();
    if (std::sscanf(name.c_str(), "mesh/model.of-selections-%9d.ply", &n) == 1 && n > 0 &&
        name == kept_name(n)) {
      numbers.insert(n);
    }
  }
  return numbers;
}

bool is_of(const fs::path& mesh, const std::string& surface_xxh128) {
  const Result<Mesh> read = read_mesh(mesh);
  return read && surface_digest(*read) == surface_xxh128;
}

}  // namespace

std::vector<std::string> meshes_of_selections(const fs::path& session, const std::string& surface_xxh128) {
  std::vector<std::string> out;
  if (is_there(session / kSessionMesh) && is_of(session / kSessionMesh, surface_xxh128)) {
    out.emplace_back(kSessionMesh);
  }
  for (const std::string& name : kept_selected_meshes(session)) {
    if (is_of(session / name, surface_xxh128)) {
      out.push_back(name);
    }
  }
  return out;
}

std::optional<fs::path> mesh_of_selections(const fs::path& selections) {
  const Result<SelectionFile> file = read_selections(selections);
  const fs::path folder = selections.parent_path().parent_path();
  for (const fs::path& session : {folder, folder / "kept"}) {
    const std::vector<std::string> there =
        file ? meshes_of_selections(session, file->surface_xxh128) : std::vector<std::string>();
    if (!there.empty()) {
      return session / there.front();
    }
  }
  return std::nullopt;
}

std::vector<std::string> kept_selected_meshes(const fs::path& session) {
  std::vector<std::string> out;
  for (const int n : kept_numbers(session)) {
    out.push_back(kept_name(n));
  }
  return out;
}

Status keep_selected_mesh(SessionStore& store, const Mesh& next) {
  const fs::path& session = store.folder();
  if (!is_there(session / kSelections) || !is_there(session / kSessionMesh)) {
    return {};
  }
  const Result<SelectionFile> file = read_selections(session / kSelections);
  if (!file || file->selections.empty() || file->surface_xxh128 == surface_digest(next)) {
    return {};
  }
  const std::vector<std::string> there = meshes_of_selections(session, file->surface_xxh128);
  if (there.size() != 1 || there.front() != kSessionMesh) {
    return {};  // nowhere, or kept before
  }
  const Result<std::string> bytes = read_whole_file(session / kSessionMesh);
  if (!bytes) {
    return std::unexpected(bytes.error());
  }
  const std::set<int> numbers = kept_numbers(session);
  const std::string name = kept_name(numbers.empty() ? 1 : *numbers.rbegin() + 1);
  const Status kept = store.replace_file(
      name, [&](const fs::path& to) { return write_file_atomically(to, std::string_view(*bytes)); });
  if (kept) {
    log_info(
        fmt::format("the mesh that {} is of stays as {}: a mesh of other scans or places takes its place",
                    kSelections, name));
  }
  return kept;
}

}  // namespace dubsar
