// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <Eigen/Core>
#include <algorithm>
#include <array>

#include "formats/place_precision.h"
#include "formats/scan_samples.h"
#include "formats/seen_side.h"
#include "formats/text_scanner.h"
#include "formats/text_scans.h"

namespace dubsar {

namespace {

constexpr const char* kExportAgain = "the file is cut short or not PTX: copy or export it again";
constexpr std::int64_t kMaxSide = std::int64_t{1} << 24U;
constexpr int kHeaderNumbers = 3 + 9 + 16;
/// A line of a sample is at least "0 0 0".
constexpr std::size_t kLeastSampleBytes = 6;
/// Fewer show nothing of where they were seen from.
constexpr std::size_t kLeastSamples = 1000;

struct PtxHeader {
  int profiles = 0;
  int samples = 0;  ///< of a profile
};

std::unexpected<Error> ptx_error(const TextScanner& text, const std::string& name, const std::string& what) {
  return bad_input(name, "line " + std::to_string(text.line_number()) + ": " + what, kExportAgain);
}

Result<PtxHeader> read_header(TextScanner& text, const std::string& name) {
  std::array<std::int64_t, 2> sides{};
  for (std::int64_t& side : sides) {
    const std::string word = text.word_here();
    const std::size_t line = text.line_number();
    if (!text.integer(side) || side < 1 || side > kMaxSide) {
      return bad_input(name,
                       "line " + std::to_string(line) + ": " + in_quotes(word) +
                           " stands where a count from 1 to " + std::to_string(kMaxSide) + " belongs",
                       kExportAgain);
    }
  }
  for (int i = 0; i < kHeaderNumbers; ++i) {
    double ignored = 0;
    if (!text.number(ignored)) {
      return ptx_error(text, name, in_quotes(text.word_here()) + " stands where the scanner's pose belongs");
    }
  }
  (void)text.line();
  const auto cells = static_cast<std::uint64_t>(sides[0]) * static_cast<std::uint64_t>(sides[1]);
  if (cells > (text.remaining() + 1) / kLeastSampleBytes) {
    return ptx_error(text, name,
                     "claims " + std::to_string(sides[0]) + " x " + std::to_string(sides[1]) +
                         " samples, but only " + std::to_string(text.remaining()) +
                         " bytes are left for them");
  }
  return PtxHeader{static_cast<int>(sides[0]), static_cast<int>(sides[1])};
}

/// How many numbers the next line has, up to 8.
int columns_of_next_line(TextScanner text) {
  std::string_view line = text.line();
  int columns = 0;
  for (double ignored = 0; columns < 8 && parse_number(take_word(line), ignored); ++columns) {
  }
  return columns;
}

/// No scanner of objects sees a tenth of its samples so far off the middle of its view: what has its origin
/// there has been moved to the object.
constexpr double kWidestCosine = 0.5;
constexpr double kFewOutside = 0.1;

/// The scanner stands at the origin, unless the origin lies in the surface or rows and columns were plainly
/// seen from elsewhere: that is answered with a remark.
Result<std::string> place_scanner(RangeGrid& grid, const std::string& name) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d rays = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0) {
      const Eigen::Vector3d p = grid.point(i).cast<double>();
      sum += p;
      rays += p.normalized();
    }
  }
  std::size_t outside = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Eigen::Vector3d p = grid.point(i).cast<double>();
    outside += grid.valid[i] != 0 && p.dot(rays) < kWidestCosine * p.norm() * rays.norm() ? 1 : 0;
  }
  if (static_cast<double>(outside) > kFewOutside * static_cast<double>(grid.valid_count()) &&
      grid.valid_count() >= kLeastSamples) {
    if (const Status found = find_direction(grid, name); !found) {
      return std::unexpected(found.error());
    }
    return "the scanner would stand at 0 0 0, in the scanned surface: which way it looked is taken from the "
           "outline; better export it in the scanner's own frame";
  }
  if (sum.norm() > 0) {
    grid.view.direction = sum.normalized();
  }
  const bool from_behind = outline_side(grid) < 0;
  if (from_behind) {
    grid.view.direction = -grid.view.direction;
  }
  if (take_shown_axis(grid) || from_behind) {
    return "the scanner would stand at 0 0 0, but its rows and columns were not seen from there: which way "
           "it "
           "looked is taken from them; better export it in the scanner's own frame";
  }
  grid.view.laser_mm = Eigen::Vector3d::Zero();
  grid.view.camera_mm = Eigen::Vector3d::Zero();
  return std::string();
}

Result<RangeGrid> read_one(TextScanner& text, const std::string& name, double mm, std::string& remark) {
  const Result<PtxHeader> header = read_header(text, name);
  if (!header) {
    return std::unexpected(header.error());
  }
  const int columns = columns_of_next_line(text);
  if (columns != 3 && columns != 4 && columns != 7) {
    return ptx_error(text, name, "a sample has " + std::to_string(columns) + " numbers, not 3, 4 or 7");
  }
  const std::size_t cells =
      static_cast<std::size_t>(header->profiles) * static_cast<std::size_t>(header->samples);
  ScanSamples samples;
  for (std::size_t i = 0; i < cells; ++i) {
    std::array<double, 7> v{};
    for (int k = 0; k < columns; ++k) {
      if (!text.number(v[static_cast<std::size_t>(k)])) {
        return ptx_error(
            text, name,
            text.at_end()
                ? "ends at sample " + std::to_string(i) + " of " + std::to_string(cells)
                : "sample " + std::to_string(i) + ": " + in_quotes(text.word_here()) + " is not a number");
      }
    }
    samples.add(mm * v[0], mm * v[1], mm * v[2], v[0] != 0 || v[1] != 0 || v[2] != 0);
    if (columns > 3) {
      samples.intensity.push_back(static_cast<float>(v[3]));
    }
    for (std::size_t k = 4; columns == 7 && k < 7; ++k) {
      samples.rgb.push_back(v[k] > 0 ? static_cast<std::uint8_t>(std::min(v[k], 255.0)) : std::uint8_t{0});
    }
  }
  if (const Status near = samples.check_place(name); !near) {
    return std::unexpected(near.error());
  }
  RangeGrid grid = grid_from_samples(samples, header->profiles, header->samples, {});
  const Result<std::string> doubt = place_scanner(grid, name);
  if (!doubt) {
    return std::unexpected(doubt.error());
  }
  remark = *doubt;
  grid.spacing_mm = estimate_spacing_mm(grid);
  if (const Status precise = check_precision(grid, name); !precise) {
    return std::unexpected(precise.error());
  }
  return grid;
}

}  // namespace

Result<std::vector<ScanData>> read_ptx(std::string_view bytes, const std::string& name,
                                       const GridReadOptions& options) {
  TextScanner text(bytes);
  std::vector<RangeGrid> grids;
  std::vector<std::string> remarks;
  bool any_sample = false;
  while (!text.at_end() || grids.empty()) {
    Result<RangeGrid> grid = read_one(text, name, options.mm_per_unit.value_or(1.0), remarks.emplace_back());
    if (!grid) {
      return std::unexpected(grid.error());
    }
    any_sample = any_sample || grid->valid_count() > 0;
    grids.push_back(std::move(*grid));
  }
  if (!any_sample) {
    return bad_input(name, "holds no usable sample", "export the scan again");
  }
  std::vector<ScanData> scans;
  for (std::size_t i = 0; i < grids.size(); ++i) {
    grids[i].source = file_name_of(name);
    if (grids.size() > 1) {
      grids[i].source += '#';
      grids[i].source += std::to_string(i);
    }
    if (!remarks[i].empty() && options.remark) {
      options.remark(grids[i].source, remarks[i]);
    }
    scans.emplace_back(std::move(grids[i]));
  }
  return scans;
}

Result<int> count_ptx_scans(std::string_view bytes, const std::string& name) {
  TextScanner text(bytes);
  int count = 0;
  while (!text.at_end() || count == 0) {
    const Result<PtxHeader> header = read_header(text, name);
    if (!header) {
      return std::unexpected(header.error());
    }
    const std::size_t cells =
        static_cast<std::size_t>(header->profiles) * static_cast<std::size_t>(header->samples);
    for (std::size_t i = 0; i < cells; ++i) {
      text.skip_blanks();
      if (text.line().empty()) {
        return ptx_error(text, name, "ends at sample " + std::to_string(i) + " of " + std::to_string(cells));
      }
    }
    ++count;
  }
  return count;
}

}  // namespace dubsar
