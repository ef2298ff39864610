// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/command/mesh_unit.h"

#include <optional>
#include <utility>

#include "analysis/tablet_size.h"
#include "core/log.h"
#include "core/units.h"
#include "formats/atomic_file.h"
#include "formats/filed_mesh.h"
#include "formats/ply_header.h"
#include "station/mesh_unit_doubt.h"

namespace dubsar {

Result<MeshInItsUnit> read_mesh_in_its_unit(const std::string& file, const std::string& unit,
                                            const JobContext& job) {
  const Result<std::string> bytes = read_whole_file(file);
  if (!bytes) {
    return std::unexpected(bytes.error());
  }
  const auto read_as = [&](std::optional<double> mm) {
    return read_filed_mesh_bytes(*bytes, file, {.mm_per_unit = mm, .job = &job});
  };
  MeshInItsUnit out;
  Result<FiledMesh> read = read_as(unit.empty() ? std::nullopt : mm_per_unit(unit));
  if (!read) {
    return std::unexpected(read.error());
  }
  const double across_mm = size_across_mm(read->mesh);
  if (unit.empty() && across_mm > 0 && !is_inscribed_size(across_mm)) {
    const Result<FiledMesh> as_numbers = read_as(1.0);
    if (!as_numbers) {
      return std::unexpected(as_numbers.error());
    }
    const Eigen::Vector3d numbers = size_mm(as_numbers->mesh);
    const Result<UnitBySize> told =
        unit_by_size(numbers, across_mm / numbers.norm(), states_unit(*bytes, file), file);
    if (!told) {
      return std::unexpected(told.error());
    }
    if (!told->taken_for.empty()) {
      read = read_as(mm_per_unit(told->taken_for));
      if (!read) {
        return std::unexpected(read.error());
      }
      out.unit_assumed = told->taken_for;
      log_warning(told->doubt.line());
    }
  }
  if (const Status measurable = check_measurable(read->mesh, file); !measurable) {
    return std::unexpected(measurable.error());
  }
  out.mesh = std::move(read->mesh);
  out.file_vertices = read->file_vertices;
  out.vertex_of = std::move(read->vertex_of);
  return out;
}

}  // namespace dubsar
