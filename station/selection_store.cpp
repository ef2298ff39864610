// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/selection_store.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/inside_out.h"
#include "core/near_cells.h"
#include "formats/selections_json.h"
#include "station/selected_mesh.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// A depth point lies on the clay; where no vertex is this near, the wedges are of another mesh.
constexpr float kReachMm = 1.0F;

/// Nothing where there is no file.
Result<std::optional<SelectionFile>> read_if_there(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) {
    return std::nullopt;
  }
  Result<SelectionFile> read = read_selections(file);
  return read ? Result<std::optional<SelectionFile>>(*std::move(read)) : std::unexpected(read.error());
}

/// A mesh that is inside out may have been turned over when they were made: its numbers stayed as they are.
bool is_surface_of(const SelectionFile& file, const Mesh& mesh) {
  if (file.surface_xxh128 == surface_digest(mesh)) {
    return true;
  }
  Mesh other_way;
  other_way.positions = mesh.positions;
  other_way.faces = mesh.faces;
  turn_over(&other_way);
  return file.surface_xxh128 == surface_digest(other_way);
}

bool is_of(const SelectionFile& file, const Mesh& mesh) {
  return is_surface_of(file, mesh) &&
         std::ranges::all_of(file.selections, [&](const MeshSelection& one) { return fits(one, mesh); });
}

}  // namespace

fs::path selections_file_of(const fs::path& mesh) {
  const fs::path session = fs::absolute(mesh).lexically_normal().parent_path().parent_path();
  std::error_code error;
  if (fs::is_regular_file(session / "session.sqlite", error)) {
    return session / "analysis" / "selections.json";
  }
  fs::path own = mesh;
  return own.replace_extension(".selections.json");
}

Result<std::vector<MeshSelection>> kept_selections(const fs::path& file, const Mesh& mesh) {
  Result<std::optional<SelectionFile>> read = read_if_there(file);
  if (!read) {
    return std::unexpected(read.error());
  }
  if (!*read) {
    return std::vector<MeshSelection>();
  }
  if (!is_of(**read, mesh)) {
    return fail(ErrorKind::kBadInput, "these selections are of another surface than the mesh has now",
                file.string(), "select again; the file is put aside when a selection is kept");
  }
  return std::move((*read)->selections);
}

Result<MeshSelection> kept_selection(const fs::path& file, const Mesh& mesh, const std::string& name) {
  Result<std::vector<MeshSelection>> kept = kept_selections(file, mesh);
  if (!kept) {
    Error error = kept.error();
    if (const std::optional<fs::path> other = mesh_of_selections(file)) {
      error.mend = "they are of " + other->string() + ": name that mesh, or select again";
    }
    return std::unexpected(std::move(error));
  }
  for (MeshSelection& one : *kept) {
    if (one.name == name) {
      return std::move(one);
    }
  }
  std::string names;
  for (const MeshSelection& one : *kept) {
    names += (names.empty() ? "there are: " : ", ") + one.name;
  }
  return fail(ErrorKind::kUsage, "there is no selection '" + name + "'", file.string(),
              names.empty() ? "select in the viewer and keep it under that name" : names);
}

Status keep_selections(const fs::path& file, const std::string& mesh_name, const Mesh& mesh,
                       std::vector<MeshSelection> selections) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);  // what is wrong then is said by the writing
  const Result<std::optional<SelectionFile>> before = read_if_there(file);
  if (!before || (*before && !is_of(**before, mesh))) {
    fs::path aside;
    for (int k = 1; aside.empty() || fs::exists(aside, error); ++k) {
      aside = file;
      aside += '.';
      aside += std::to_string(k);
    }
    fs::rename(file, aside, error);
    if (error) {
      return fail(ErrorKind::kStorage, error.message(), file.string(), "move it out of the way");
    }
  }
  return write_selections(file, {mesh_name, surface_digest(mesh), std::move(selections)});
}

std::vector<Wedge> selected_wedges(const std::vector<Wedge>& wedges, const Mesh& mesh,
                                   const MeshSelection& selection) {
  NearCells around(kReachMm);
  for (std::size_t w = 0; w < wedges.size(); ++w) {
    around.add(wedges[w].depth_point_mm.cast<float>().cast<double>(), w);
  }
  std::vector<std::pair<float, std::size_t>> nearest(wedges.size(),
                                                     {kReachMm * kReachMm, mesh.positions.size()});
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Eigen::Vector3f& p = mesh.positions[v];
    if (!p.allFinite()) {
      continue;
    }
    for (const std::size_t w : around.about(p.cast<double>())) {
      const float off = (p - wedges[w].depth_point_mm.cast<float>()).squaredNorm();
      if (off < nearest[w].first) {
        nearest[w] = {off, v};
      }
    }
  }
  const std::vector<std::uint8_t> taken = selected_vertices(mesh, selection);
  std::vector<Wedge> out;
  for (std::size_t w = 0; w < wedges.size(); ++w) {
    if (nearest[w].second < taken.size() && taken[nearest[w].second] != 0) {
      out.push_back(wedges[w]);
    }
  }
  return out;
}

}  // namespace dubsar
