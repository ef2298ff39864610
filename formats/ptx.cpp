// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <Eigen/Core>
#include <algorithm>
#include <array>

#include "formats/place_precision.h"
#include "formats/ptx_samples.h"
#include "formats/scan_samples.h"
#include "formats/seen_side.h"
#include "formats/text_scanner.h"
#include "formats/text_scans.h"

namespace dubsar {

namespace {

constexpr std::int64_t kMaxSide = std::int64_t{1} << 24U;
constexpr int kHeaderNumbers = 3 + 9 + 16;
/// A line of a sample is at least "0 0 0".
constexpr std::size_t kLeastSampleBytes = 6;
/// Fewer show nothing of where they were seen from.
constexpr std::size_t kLeastSamples = 1000;

struct PtxHeader {
  int profiles = 0;  ///< both are 0 for a scan of no samples
  int samples = 0;   ///< of a profile
};

struct PtxText {
  TextScanner text;
  char line_end;

  // Lines of an old Macintosh end with a carriage return alone.
  explicit PtxText(std::string_view bytes)
      : text(bytes), line_end(bytes.contains('\n') || !bytes.contains('\r') ? '\n' : '\r') {}
};

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Nothing in PTX has a comma but a number that was written in a country of decimal commas. kBadInput where a
/// file has points as well, or commas beside something else than digits.
Result<std::string> with_decimal_points(std::string_view bytes, const std::string& name) {
  const bool has_points = bytes.contains('.');
  std::string out(bytes);
  for (std::size_t at = bytes.find(','); at != std::string_view::npos; at = bytes.find(',', at + 1)) {
    const bool in_number =
        at > 0 && at + 1 < bytes.size() && is_digit(bytes[at - 1]) && is_digit(bytes[at + 1]);
    if (!in_number || has_points) {
      TextScanner text(bytes);
      text.seek(at);
      return bad_input(
          name,
          "line " + std::to_string(text.line_number()) +
              (in_number ? ": its numbers have commas, and decimal points stand in the file as well"
                         : ": a comma stands where none belongs in PTX"),
          "export it again with decimal points");
    }
    out[at] = '.';
  }
  return out;
}

/// What `read` makes of the bytes, or of the same with decimal points where their commas stopped it.
template <class Read>
auto read_either_way(std::string_view bytes, const std::string& name, const Read& read)
    -> decltype(read(bytes)) {
  auto result = read(bytes);
  if (result || result.error().kind == ErrorKind::kCancelled || !bytes.contains(',')) {
    return result;
  }
  const Result<std::string> with_points = with_decimal_points(bytes, name);
  return with_points ? read(*with_points) : std::unexpected(with_points.error());
}

Result<PtxHeader> read_header(PtxText& file, const std::string& name) {
  TextScanner& text = file.text;
  std::array<std::int64_t, 2> sides{};
  for (std::int64_t& side : sides) {
    text.skip_blanks();
    const std::size_t start = text.position();
    if (!text.integer(side) || side < 0 || side > kMaxSide) {
      text.seek(start);  // lines are counted from the file's first: not of each scan, but where it is said
      return ptx_error(text, name,
                       in_quotes(text.word_here()) + " stands where a count from 1 to " +
                           std::to_string(kMaxSide) + " belongs");
    }
  }
  for (int i = 0; i < kHeaderNumbers; ++i) {
    double ignored = 0;
    if (!text.number(ignored)) {
      return ptx_error(text, name, in_quotes(text.word_here()) + " stands where the scanner's pose belongs");
    }
  }
  (void)text.line(file.line_end);
  const auto cells = static_cast<std::uint64_t>(sides[0]) * static_cast<std::uint64_t>(sides[1]);
  if (cells == 0) {
    return PtxHeader{};
  }
  if (cells > (text.remaining() + 1) / kLeastSampleBytes) {
    return ptx_error(text, name,
                     "claims " + std::to_string(sides[0]) + " x " + std::to_string(sides[1]) +
                         " samples, but only " + std::to_string(text.remaining()) +
                         " bytes are left for them");
  }
  return PtxHeader{static_cast<int>(sides[0]), static_cast<int>(sides[1])};
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

/// The next scan; one without a cell where the file has one of no samples.
Result<RangeGrid> read_one(PtxText& file, const std::string& name, const GridReadOptions& options,
                           std::string& remark) {
  const Result<PtxHeader> header = read_header(file, name);
  if (!header) {
    return std::unexpected(header.error());
  }
  if (header->profiles == 0) {
    return RangeGrid{};
  }
  const std::size_t cells =
      static_cast<std::size_t>(header->profiles) * static_cast<std::size_t>(header->samples);
  const Result<ScanSamples> samples =
      read_ptx_samples(file.text, file.line_end, cells, options.mm_per_unit.value_or(1.0), name, options.job);
  if (!samples) {
    return std::unexpected(samples.error());
  }
  if (const Status near = samples->check_place(name); !near) {
    return std::unexpected(near.error());
  }
  RangeGrid grid = grid_from_samples(*samples, header->profiles, header->samples, {});
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

Result<std::vector<ScanData>> read_all(std::string_view bytes, const std::string& name,
                                       const GridReadOptions& options) {
  PtxText file(bytes);
  std::vector<RangeGrid> grids;
  std::vector<std::string> remarks;
  bool any_sample = false;
  while (!file.text.at_end() || grids.empty()) {
    Result<RangeGrid> grid = read_one(file, name, options, remarks.emplace_back());
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
  std::vector<std::string> empty;
  for (std::size_t i = 0; i < grids.size(); ++i) {
    grids[i].source = file_name_of(name);
    if (grids.size() > 1) {
      grids[i].source += '#';
      grids[i].source += std::to_string(i);
    }
    if (grids[i].size() == 0) {
      empty.push_back(grids[i].source);
      continue;
    }
    if (!remarks[i].empty() && options.remark) {
      options.remark(grids[i].source, remarks[i]);
    }
    scans.emplace_back(std::move(grids[i]));
  }
  for (const std::string& scan : empty) {
    if (options.remark) {
      options.remark(std::get<RangeGrid>(scans.front()).source,
                     scan + " beside it has no samples and is passed over");
    }
  }
  return scans;
}

Result<int> count_all(std::string_view bytes, const std::string& name) {
  PtxText file(bytes);
  int count = 0;
  do {
    const Result<PtxHeader> header = read_header(file, name);
    if (!header) {
      return std::unexpected(header.error());
    }
    const std::size_t cells =
        static_cast<std::size_t>(header->profiles) * static_cast<std::size_t>(header->samples);
    for (std::size_t i = 0; i < cells; ++i) {
      file.text.skip_blanks();
      if (file.text.line(file.line_end).empty()) {
        return ptx_error(file.text, name,
                         "ends at sample " + std::to_string(i) + " of " + std::to_string(cells));
      }
    }
    count += cells > 0 ? 1 : 0;
  } while (!file.text.at_end());
  return count;
}

}  // namespace

Result<std::vector<ScanData>> read_ptx(std::string_view bytes, const std::string& name,
                                       const GridReadOptions& options) {
  if (bytes.empty()) {
    return bad_input(name, "the file is empty", "copy or export it again");
  }
  return read_either_way(bytes, name, [&](std::string_view text) { return read_all(text, name, options); });
}

Result<int> count_ptx_scans(std::string_view bytes, const std::string& name) {
  return read_either_way(bytes, name, [&](std::string_view text) { return count_all(text, name); });
}

}  // namespace dubsar
