// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/mesh_to_view.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <limits>
#include <string>
#include <utility>

#include "core/units.h"
#include "formats/file_label_reader.h"
#include "formats/mesh_io.h"
#include "formats/wedges_json.h"
#include "station/analysis_asked.h"
#include "station/mesh_unit_doubt.h"
#include "station/outward_faces.h"
#include "station/wedges_on_mesh.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// What single precision spoils.
std::optional<Error> far_from_origin(const Mesh& mesh, const std::string& where) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh.positions) {
    if (p.allFinite()) {
      box.extend(p);
    }
  }
  if (box.isEmpty()) {
    return std::nullopt;
  }
  const double size_mm = static_cast<double>(box.diagonal().norm());
  const double far_mm = static_cast<double>(box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff());
  const double step_mm = far_mm * static_cast<double>(std::numeric_limits<float>::epsilon());
  constexpr double kCoarseStep = 2e-5;  // of the size: a micrometre on a tablet of 5 cm
  if (step_mm <= kCoarseStep * size_mm) {
    return std::nullopt;
  }
  return Error{
      ErrorKind::kBadInput,
      fmt::format("it lies {:.0f} mm from the origin of its numbers, where places are good to {:.2g} mm",
                  far_mm, step_mm),
      where, "export it again with its middle at the origin"};
}

/// The unit that wedges were measured in, where that is not the file's own.
struct UnitOfWedges {
  std::string unit;
  bool is_assumed = false;  ///< by the mesh's size alone
  std::vector<Wedge> wedges;
};

UnitOfWedges unit_of_wedges(const fs::path& wedges_file) {
  std::error_code none;
  Result<WedgeFile> known = fs::is_regular_file(wedges_file, none) ? read_wedges(wedges_file) : WedgeFile();
  if (!known) {
    return {};
  }
  AnalysisAsked asked;
  asked.out = wedges_file.string();
  take_known_options(asked, [](const char*) { return false; });
  const bool is_assumed = asked.unit.empty();
  return {is_assumed ? known->unit_assumed : asked.unit, is_assumed, std::move(known->wedges)};
}

}  // namespace

Result<MeshToView> read_mesh_to_view(const fs::path& file, const fs::path& wedges_file) {
  const std::string where = file.filename().string();
  const auto read_as = [&](std::optional<double> mm) {
    return read_mesh(file, {.mm_per_unit = mm, .may_be_points = true});
  };
  Result<Mesh> read = read_as(std::nullopt);
  if (!read) {
    return std::unexpected(read.error());
  }
  MeshToView out;
  std::optional<Error> doubt = unit_doubt(*read, file, where);
  const UnitOfWedges known = unit_of_wedges(wedges_file);
  Result<Mesh> as_known = known.unit.empty() ? bad_input(where, {}) : read_as(mm_per_unit(known.unit));
  if (as_known && !of_another_mesh(known.wedges, *as_known, {})) {
    read = std::move(as_known);
    out.unit_assumed = doubt && known.is_assumed ? known.unit : std::string();
    doubt = doubt && known.is_assumed ? std::optional(unit_taken(known.unit, *doubt)) : std::nullopt;
  } else if (doubt) {
    const Result<UnitBySize> told = unit_by_size(*read, file);
    if (!told) {
      out.unmeasured =
          Error{ErrorKind::kBadInput, "its wedges are not measured before it is said what its numbers are",
                where, doubt->mend};
    } else if (!told->taken_for.empty()) {
      read = read_as(mm_per_unit(told->taken_for));
      if (!read) {
        return std::unexpected(read.error());
      }
      out.unit_assumed = told->taken_for;
      doubt = unit_taken(told->taken_for, *doubt);
    }
  }
  out.label = read_mesh_label(file);
  if (doubt) {
    out.label.words.emplace_back("Unit", doubt->what);
  }
  const std::optional<Error> turned = turned_outwards(&*read, where);
  for (const std::optional<Error>& one : {far_from_origin(*read, where), doubt, turned}) {
    if (one) {
      out.doubts.push_back(*one);
    }
  }
  out.mesh = std::move(*read);
  return out;
}

}  // namespace dubsar
