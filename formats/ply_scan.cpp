// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/ply_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/number_text.h"
#include "core/seen_all_round.h"
#include "core/units.h"
#include "formats/bytes_left_over.h"
#include "formats/colour_values.h"
#include "formats/place_precision.h"
#include "formats/ply_body.h"
#include "formats/ply_scan_info.h"
#include "formats/scan_samples.h"
#include "formats/seen_side.h"
#include "formats/text_scanner.h"
#include "formats/unit_name.h"

namespace dubsar {

namespace {

constexpr const char* kExportAgain = "export the scan again";
constexpr std::int64_t kMaxGridSide = std::int64_t{1} << 24U;

struct GridSize {
  int rows = 0;
  int cols = 0;
  [[nodiscard]] std::uint64_t cells() const {
    return static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(cols);
  }
};

Result<std::optional<int>> read_side(const PlyHeader& header, const char* key, const std::string& name) {
  const std::optional<std::string_view> value = header.info_value(key);
  if (!value) {
    return std::nullopt;
  }
  std::string_view rest = *value;
  const std::string_view word = take_word(rest);
  std::int64_t side = 0;
  if (!parse_integer(word, side) || side < 1 || side > kMaxGridSide) {
    return bad_input(name,
                     "obj_info " + std::string(key) + " is " + in_quotes(word) +
                         ", not a whole number from 1 to " + std::to_string(kMaxGridSide),
                     kExportAgain);
  }
  return static_cast<int>(side);
}

/// The size that obj_info states; nothing when it states none.
Result<std::optional<GridSize>> read_size(const PlyHeader& header, const std::string& name) {
  const auto rows = read_side(header, ply_info::kRows, name);
  if (!rows) {
    return std::unexpected(rows.error());
  }
  const auto cols = read_side(header, ply_info::kCols, name);
  if (!cols) {
    return std::unexpected(cols.error());
  }
  if (!*rows || !*cols) {
    return std::nullopt;
  }
  return GridSize{**rows, **cols};
}

/// Where the vertex properties stand.
struct VertexColumns {
  int x, y, z, valid, intensity, confidence;
  std::array<int, 3> normal;
  double intensity_scale = 1;
  float confidence_largest = 1;  ///< what its type reaches to, 1 of floating-point numbers

  explicit VertexColumns(const PlyElement& vertex)
      : x(vertex.scalar("x")),
        y(vertex.scalar("y")),
        z(vertex.scalar("z")),
        valid(vertex.scalar("valid")),
        intensity(vertex.scalar("intensity")),
        confidence(vertex.scalar("confidence")),
        normal{vertex.scalar("nx"), vertex.scalar("ny"), vertex.scalar("nz")} {
    const auto type_of = [&](int p) { return vertex.properties[static_cast<std::size_t>(p)].type; };
    if (intensity >= 0 && type_of(intensity) == PlyType::kUint8) {
      intensity_scale = 1.0 / 255.0;
    } else if (intensity >= 0 && type_of(intensity) == PlyType::kUint16) {
      intensity_scale = 1.0 / 65535.0;
    }
    if (confidence >= 0 && type_of(confidence) == PlyType::kUint8) {
      confidence_largest = 255;
    } else if (confidence >= 0 && type_of(confidence) == PlyType::kUint16) {
      confidence_largest = 65535;
    }
  }
  [[nodiscard]] static bool has(const std::array<int, 3>& three) {
    return three[0] >= 0 && three[1] >= 0 && three[2] >= 0;
  }
};

/// To 0 to 1, from whole numbers up to `largest` where any of them is above 1 (others are 0 and 1
/// themselves); what lies above becomes 1.
void scale_confidence(float largest, std::vector<float>& confidence) {
  const bool whole = std::ranges::any_of(confidence, [](float c) { return c > 1; });
  for (float& c : confidence) {
    c = std::min(whole ? c / largest : c, 1.0F);
  }
}

Result<ScanSamples> read_vertices(PlyBody& body, const PlyElement& vertex, double mm,
                                  const std::string& name) {
  const VertexColumns columns(vertex);
  for (const auto& [property, letter] : {std::pair{columns.x, "x"}, {columns.y, "y"}, {columns.z, "z"}}) {
    if (property < 0) {
      return bad_input(name, std::string("its vertices have no ") + letter, kExportAgain);
    }
  }
  if (vertex.count >= kNoSample) {
    return bad_input(name,
                     "claims " + std::to_string(vertex.count) + " vertices; at most 4294967294 are read",
                     "split the scan");
  }
  if (Status claim = body.check_claim(vertex); !claim) {
    return std::unexpected(claim.error());
  }
  ScanSamples samples;
  const auto count = static_cast<std::size_t>(vertex.count);
  samples.x.reserve(count);
  samples.y.reserve(count);
  samples.z.reserve(count);
  samples.usable.reserve(count);
  PlyColours colours(vertex);
  const Status done = body.read(vertex, [&](std::uint64_t index, const PlyRow& row) -> Status {
    samples.add(mm * row.value(columns.x), mm * row.value(columns.y), mm * row.value(columns.z),
                row.value(columns.valid, 1.0) != 0.0);
    if (columns.intensity >= 0) {
      samples.intensity.push_back(static_cast<float>(columns.intensity_scale * row.value(columns.intensity)));
    }
    if (columns.confidence >= 0) {
      const double confidence = row.value(columns.confidence);
      samples.confidence.push_back(confidence > 0 ? static_cast<float>(confidence) : 0.0F);
    }
    colours.put(static_cast<std::size_t>(index), [&](int property) { return row.value(property); });
    for (std::size_t k = 0; k < 3 && VertexColumns::has(columns.normal); ++k) {
      samples.normals.push_back(static_cast<float>(row.value(columns.normal[k])));
    }
    return {};
  });
  if (!done) {
    return std::unexpected(done.error());
  }
  scale_confidence(columns.confidence_largest, samples.confidence);
  samples.rgb.reserve(colours.any() ? 3 * count : 0);
  for (const std::array<std::uint8_t, 3>& rgb : colours.take()) {
    samples.rgb.insert(samples.rgb.end(), rgb.begin(), rgb.end());
  }
  return samples;
}

/// The vertex of each cell, kNoSample where there was no return.
Result<std::vector<std::uint32_t>> read_cells(PlyBody& body, const PlyElement& grid, std::uint64_t vertices,
                                              const std::string& name) {
  const int list = grid.first_list();
  if (list < 0) {
    return bad_input(name, "its range_grid element has no list of vertex indices", kExportAgain);
  }
  if (Status claim = body.check_claim(grid); !claim) {
    return std::unexpected(claim.error());
  }
  std::vector<std::uint32_t> cells(static_cast<std::size_t>(grid.count), kNoSample);
  // One bit per vertex would do; the vertices may still follow, so this is bounded by the largest index seen.
  std::vector<std::uint8_t> taken;
  const Status done = body.read(grid, [&](std::uint64_t cell, const PlyRow& row) -> Status {
    const std::vector<double>& indices = row.lists[static_cast<std::size_t>(list)];
    if (indices.empty()) {
      return {};
    }
    if (indices.size() > 1) {
      return body.error_at(
          grid, cell, "holds " + std::to_string(indices.size()) + " vertices, not one or none", kExportAgain);
    }
    const double index = indices.front();
    if (index == -1) {  // as some exporters write no return
      return {};
    }
    if (!(index >= 0 && index < static_cast<double>(vertices) && index == std::floor(index))) {
      return body.error_at(grid, cell,
                           "vertex index " + number_text(index) + " is not one of the " +
                               std::to_string(vertices) + " vertices",
                           kExportAgain);
    }
    const auto vertex = static_cast<std::size_t>(index);
    if (taken.empty()) {
      taken.resize(static_cast<std::size_t>(vertices));
    }
    if (taken[vertex] != 0) {
      return body.error_at(grid, cell, "vertex " + std::to_string(vertex) + " already stands in another cell",
                           kExportAgain);
    }
    taken[vertex] = 1;
    cells[static_cast<std::size_t>(cell)] = static_cast<std::uint32_t>(vertex);
    return {};
  });
  if (!done) {
    return std::unexpected(done.error());
  }
  return cells;
}

/// 0 0 0 stands for no return in ordered files that have nothing better.
void drop_zero_points(ScanSamples& samples) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples.x[i] == 0 && samples.y[i] == 0 && samples.z[i] == 0) {
      samples.usable[i] = 0;
    }
  }
}

/// What the scanner is set to differs from what the samples show by the depth of the object in its field.
constexpr double kSpacingWithin = 1.5;
/// No scanner's setting is so far off; rows of the wrong length lay samples beside each other that are none.
constexpr double kMixedUpFrom = 8.0;

/// Answers with what the operator should know; empty: nothing.
std::string settle_spacing(RangeGrid& grid, bool in_its_unit) {
  const double measured_mm = estimate_spacing_mm(grid);
  const double said_mm = in_its_unit ? grid.spacing_mm : 0.0;
  if (said_mm <= 0) {
    grid.spacing_mm = measured_mm;
  } else if (measured_mm > 0 &&
             (said_mm > kSpacingWithin * measured_mm || measured_mm > kSpacingWithin * said_mm)) {
    grid.spacing_mm = measured_mm;
    if (measured_mm > kMixedUpFrom * said_mm) {
      return "its header says a spacing of " + short_text(said_mm, 3) +
             " mm, but neighbours in its rows lie " + short_text(measured_mm, 3) +
             " mm apart: its rows and columns do not fit its samples; look at num_cols and num_rows";
    }
    return "its header says a spacing of " + short_text(said_mm, 3) + " mm, but its samples lie " +
           short_text(measured_mm, 3) +
           " mm apart, which is taken; mend or remove `obj_info dubsar_spacing_mm`";
  }
  return {};
}

/// What went round a body on a turntable is no range grid. Told and not refused: samples that scatter across
/// the view by more than they lie apart look the same.
std::string of_all_sides(const RangeGrid& grid) {
  constexpr double kMostTurnedAway = 1.0 / 3.0;
  return grid.spacing_mm > 0 && share_turned_away(grid) > kMostTurnedAway
             ? "it is seen from all sides, while a range grid shows one: cut it into views of at most 120 "
               "degrees, a file each"
             : "";
}

Status check_sizes(const PlyHeader& header, const std::optional<GridSize>& size, const std::string& name) {
  const PlyElement* vertex = header.element("vertex");
  const PlyElement* grid = header.element("range_grid");
  if (vertex == nullptr) {
    return bad_input(name, "a PLY file without vertices", kExportAgain);
  }
  if (grid != nullptr && !size) {
    return bad_input(name, "has a range_grid but no obj_info num_rows and num_cols", kExportAgain);
  }
  if (grid != nullptr && size->cells() != grid->count) {
    return bad_input(name,
                     "obj_info says " + std::to_string(size->rows) + " x " + std::to_string(size->cols) +
                         " cells, but its range_grid has " + std::to_string(grid->count),
                     kExportAgain);
  }
  if (!is_scan_header(header)) {
    return bad_input(name, "a mesh with faces, not a scan", "give the scanner's own range grids");
  }
  return {};
}

}  // namespace

bool is_scan_header(const PlyHeader& header) {
  const PlyElement* face = header.element("face");
  return header.element("vertex") != nullptr &&
         (header.element("range_grid") != nullptr || face == nullptr || face->count == 0);
}

Result<double> mm_per_unit_of(const PlyHeader& header, const std::string& name) {
  const std::optional<std::string_view> value = header.info_value(ply_info::kUnit);
  if (!value) {
    return 1.0;
  }
  std::string_view rest = *value;
  const std::string_view word = take_word(rest);
  if (const std::optional<double> mm = mm_per_unit_as_written(word)) {
    return *mm;
  }
  return bad_input(name, "obj_info unit is " + in_quotes(word) + ", not " + std::string(kLengthUnitsText),
                   "say what the numbers are with --unit");
}

Result<ScanData> read_ply_scan(std::string_view bytes, const std::string& name,
                               const GridReadOptions& options) {
  const Result<PlyHeader> header = parse_ply_header(bytes, name);
  if (!header) {
    return std::unexpected(header.error());
  }
  const Result<std::optional<GridSize>> size = read_size(*header, name);
  if (!size) {
    return std::unexpected(size.error());
  }
  if (Status sizes = check_sizes(*header, *size, name); !sizes) {
    return std::unexpected(sizes.error());
  }
  const Result<double> said = mm_per_unit_of(*header, name);
  if (!said && !options.mm_per_unit) {
    return std::unexpected(said.error());
  }
  const double mm = options.mm_per_unit ? *options.mm_per_unit : *said;

  PlyBody body(*header, bytes, name, options.job);
  const PlyElement& vertex = *header->element("vertex");
  // Both are read here even when the indices come first: their claims are checked against the bytes.
  if (vertex.count > bytes.size()) {
    return std::unexpected(body.check_claim(vertex).error());
  }
  ScanSamples samples;
  std::vector<std::uint32_t> cells;
  for (const PlyElement& element : header->elements) {
    if (element.name == "vertex") {
      Result<ScanSamples> read = read_vertices(body, element, mm, name);
      if (!read) {
        return std::unexpected(read.error());
      }
      samples = std::move(*read);
    } else if (element.name == "range_grid") {
      Result<std::vector<std::uint32_t>> read = read_cells(body, element, vertex.count, name);
      if (!read) {
        return std::unexpected(read.error());
      }
      cells = std::move(*read);
    } else if (Status skipped = body.skip(element); !skipped) {
      return std::unexpected(skipped.error());
    }
  }

  const std::string left_over = bytes_left_over(body.rest());
  if (const Status near = samples.check_place(name); !near) {
    return std::unexpected(near.error());
  }
  const bool has_cells = header->element("range_grid") != nullptr;
  const bool ordered = has_cells || (*size && (*size)->cells() == vertex.count);
  if (!ordered) {
    PointCloud cloud = cloud_from_samples(samples);
    cloud.source = file_name_of(name);
    if (cloud.points.empty()) {
      return bad_input(name, "holds no usable point", kExportAgain);
    }
    if (!left_over.empty() && options.remark) {
      options.remark(cloud.source, left_over);
    }
    return cloud;
  }
  if (!has_cells) {
    drop_zero_points(samples);
  }
  RangeGrid grid = grid_from_samples(samples, (*size)->rows, (*size)->cols, cells);
  grid.source = file_name_of(name);
  if (Status applied = apply_scan_info(*header, name, grid); !applied) {
    return std::unexpected(applied.error());
  }
  if (grid.valid_count() == 0) {
    return bad_input(name, "holds no usable sample", kExportAgain);
  }
  // The spacing is counted across the direction. One that was written for other units says nothing.
  const bool seen_from = header->info_value(ply_info::kDirection) || grid.view.camera_mm;
  const std::string direction = seen_from ? std::string() : settle_direction(grid);
  const double told_spacing_mm = grid.spacing_mm;
  const std::string spacing = settle_spacing(grid, said && *said == mm);
  if (const Status precise = check_precision(grid, name); !precise) {
    return std::unexpected(precise.error());
  }
  const bool is_mixed_up = told_spacing_mm > 0 && grid.spacing_mm > kMixedUpFrom * told_spacing_mm;
  const std::string sides = is_mixed_up ? std::string() : of_all_sides(grid);
  for (const std::string& remark : {left_over, spacing, direction, sides}) {
    if (!remark.empty() && options.remark) {
      options.remark(grid.source, remark);
    }
  }
  return grid;
}

}  // namespace dubsar
