// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/command/mesh_unit.h"

#include <fmt/format.h>

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/tablet_size.h"
#include "core/log.h"
#include "core/number_text.h"
#include "core/units.h"
#include "formats/atomic_file.h"
#include "formats/filed_mesh.h"
#include "formats/ply_header.h"

namespace dubsar {

namespace {

/// The tip of a stylus.
constexpr double kLeastAcrossMm = 0.1;
/// Of what may be meant, as a choice: a Winkelhaken alone, and a standing stone.
constexpr double kLeastChoiceMm = 3;
constexpr double kMostChoiceMm = 3000;

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

}  // namespace

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
    const double mm_per_number = across_mm / numbers.norm();
    const std::string odd = fmt::format("it would be {:.3g} mm across", across_mm);
    const std::optional<std::string_view> likely = likely_unit(across_mm, mm_per_number);
    if (likely && !states_unit(*bytes, file)) {
      read = read_as(mm_per_unit(*likely));
      if (!read) {
        return std::unexpected(read.error());
      }
      out.unit_assumed = *likely;
      const std::string others = choices(numbers, *likely);
      log_warning(Error{ErrorKind::kBadInput,
                        odd + ", which nothing inscribed is: its numbers are taken for " + out.unit_assumed,
                        file,
                        "confirm that with " + choice(*likely, numbers) +
                            (others.empty() ? "" : ", or say what they are: " + others)}
                      .line());
    } else if (!likelier_units(across_mm, mm_per_number).empty()) {
      return bad_input(file, odd, "say what its numbers are: repeat it with " + choices(numbers, {}));
    } else if (across_mm < kLeastAcrossMm) {
      return bad_input(file, odd,
                       "nothing inscribed is that small: look what its numbers are and say so with --unit");
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
