// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/mesh_unit_doubt.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <string_view>
#include <vector>

#include "analysis/tablet_size.h"
#include "core/number_text.h"
#include "core/units.h"
#include "formats/atomic_file.h"
#include "formats/mesh_formats.h"
#include "formats/ply_header.h"
#include "formats/ply_scan.h"

namespace dubsar {

namespace {

/// The tip of a stylus.
constexpr double kLeastAcrossMm = 0.1;
/// Of what may be meant, as a choice: a Winkelhaken alone, and a standing stone.
constexpr double kLeastChoiceMm = 3;
constexpr double kMostChoiceMm = 3000;
/// No tablet and no part of one is smaller, whatever the file says; up to the other it may be a part.
constexpr double kSmallMm = 2;
constexpr double kPartMm = 6;

/// "--unit mm (32.4 x 20.1 x 9.8 mm)"
std::string choice(std::string_view unit, const Eigen::Vector3d& numbers) {
  const Eigen::Vector3d mm = *mm_per_unit(unit) * numbers;
  const auto text = [](double side_mm) {
    return side_mm < 1000 ? short_text(side_mm, 3) : fmt::format("{:.0f}", side_mm);
  };
  return fmt::format("--unit {} ({} x {} x {} mm)", unit, text(mm.x()), text(mm.y()), text(mm.z()));
}

/// "--unit m (…), --unit cm (…) or --unit in (…)": the units but `without` that may be meant.
std::string choices(const Eigen::Vector3d& numbers, std::string_view without) {
  std::vector<std::string> all;
  for (const std::string_view unit : kLengthUnits) {
    const double across_mm = *mm_per_unit(unit) * numbers.norm();
    if (unit != without && across_mm >= kLeastChoiceMm && across_mm <= kMostChoiceMm) {
      all.push_back(choice(unit, numbers));
    }
  }
  std::string out;
  for (std::size_t k = 0; k < all.size(); ++k) {
    out += k == 0 ? "" : k + 1 == all.size() ? " or " : ", ";
    out += all[k];
  }
  return out;
}

std::string conversion(std::string_view unit) {
  return unit == "mm" ? std::string("dubsar mesh convert --unit mm mends the file")
                      : fmt::format("dubsar mesh convert --unit {} makes millimetres of them", unit);
}

struct UnitOfFile {
  double mm_per_number = 1;
  bool in_header = false;  ///< of a PLY
  bool is_said = false;    ///< there, or by the format: a GLB is in metres
};

UnitOfFile unit_of_file(const std::filesystem::path& file) {
  constexpr std::size_t kHeadBytes = std::size_t{64} << 10U;
  const Result<std::string> head = read_file_head(file, kHeadBytes);
  if (head && is_glb(*head)) {
    return {.mm_per_number = *mm_per_unit("m"), .is_said = true};
  }
  if (!head || !states_unit(*head, file.string())) {
    return {};
  }
  const Result<PlyHeader> header = parse_ply_header(*head, file.string());
  return {header ? mm_per_unit_of(*header, file.string()).value_or(1.0) : 1.0, true, true};
}

/// Of a cloud without faces: around all of its points.
Eigen::Vector3d sides_mm(const Mesh& mesh) {
  if (!mesh.faces.empty()) {
    return size_mm(mesh);
  }
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh.positions) {
    if (p.allFinite()) {
      box.extend(p);
    }
  }
  return box.isEmpty() ? Eigen::Vector3d::Zero().eval() : box.sizes().cast<double>().eval();
}

}  // namespace

Result<UnitBySize> unit_by_size(const Eigen::Vector3d& numbers, double mm_per_number, bool in_header,
                                const std::string& where) {
  UnitBySize out;
  const double across_mm = mm_per_number * numbers.norm();
  if (!(across_mm > 0) || is_inscribed_size(across_mm)) {
    return out;
  }
  const std::string odd = fmt::format("it would be {:.3g} mm across", across_mm);
  const std::optional<std::string_view> likely = likely_unit(across_mm, mm_per_number);
  if (likely && !in_header) {
    out.taken_for = *likely;
    const std::string others = choices(numbers, *likely);
    out.doubt = {ErrorKind::kBadInput,
                 odd + ", which nothing inscribed is: its numbers are taken for " + out.taken_for, where,
                 "confirm that with " + choice(*likely, numbers) +
                     (others.empty() ? "" : ", or say what they are: " + others)};
    return out;
  }
  if (!likelier_units(across_mm, mm_per_number).empty()) {
    return bad_input(where, odd, "say what its numbers are: repeat it with " + choices(numbers, {}));
  }
  if (across_mm < kLeastAcrossMm) {
    return bad_input(where, odd,
                     "nothing inscribed is that small: look what its numbers are and say so with --unit");
  }
  return out;
}

Result<UnitBySize> unit_by_size(const Mesh& as_read, const std::filesystem::path& file) {
  const UnitOfFile unit = unit_of_file(file);
  return unit_by_size(sides_mm(as_read) / unit.mm_per_number, unit.mm_per_number, unit.in_header,
                      file.string());
}

std::optional<Error> unit_doubt(const Mesh& as_read, const std::filesystem::path& file,
                                const std::string& where) {
  const double across_mm = sides_mm(as_read).norm();
  if (!(across_mm > 0) || is_inscribed_size(across_mm)) {
    return std::nullopt;
  }
  const UnitOfFile unit = unit_of_file(file);
  std::vector<std::string_view> units = likelier_units(across_mm, unit.mm_per_number);
  if (units.empty() && across_mm < kSmallMm) {
    units = {"m"};
  }
  if (units.empty() && across_mm > kSmallMm && !unit.is_said) {
    return Error{ErrorKind::kBadInput,
                 fmt::format("no unit makes a tablet of it: it is {:.4g} mm", across_mm), where,
                 "look what its numbers are, and make millimetres of them"};
  }
  const bool may_be_part = across_mm >= kSmallMm && across_mm < kPartMm;
  if (units.empty() || (unit.is_said && may_be_part)) {
    return std::nullopt;
  }
  return Error{ErrorKind::kBadInput,
               fmt::format("as it stands it is {:.3g} mm large, perhaps its numbers are {}", across_mm,
                           fmt::join(units, ", ")),
               where, conversion(units.front())};
}

Error unit_taken(const std::string& unit, const Error& doubt) {
  return {doubt.kind, fmt::format("its numbers are taken for {}, by its size alone: {}", unit, doubt.what),
          doubt.where, conversion(unit)};
}

}  // namespace dubsar
