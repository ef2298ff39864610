// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/grid_reader.h"

#include <algorithm>
#include <array>
#include <span>

#include "formats/atomic_file.h"
#include "formats/grid_file.h"
#include "formats/ply_header.h"
#include "formats/ply_scan.h"
#include "formats/scan_samples.h"
#include "formats/text_scans.h"

namespace dubsar {

namespace {

enum class ScanFormat { kPly, kGrid, kPtx, kPointText, kUnknown };

/// Enough for any header that anyone writes.
constexpr std::size_t kHeadBytes = std::size_t{64} << 10U;

std::string lower_extension(const std::filesystem::path& name) {
  std::string extension = name.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
    return static_cast<char>(c >= 'A' && c <= 'Z' ? c + ('a' - 'A') : c);
  });
  return extension;
}

/// What the bytes say, then what the name says.
ScanFormat format_of(std::string_view bytes, const std::filesystem::path& name) {
  const std::string extension = lower_extension(name);
  if (extension == ".conf") {
    return ScanFormat::kUnknown;
  }
  if (is_ply(bytes)) {
    return ScanFormat::kPly;
  }
  if (is_grid_file(bytes)) {
    return ScanFormat::kGrid;
  }
  constexpr std::array<std::pair<std::string_view, ScanFormat>, 7> kByName{{
      {".ply", ScanFormat::kPly},
      {".grid", ScanFormat::kGrid},
      {".ptx", ScanFormat::kPtx},
      {".xyz", ScanFormat::kPointText},
      {".asc", ScanFormat::kPointText},
      {".txt", ScanFormat::kPointText},
      {".pts", ScanFormat::kPointText},
  }};
  for (const auto& [known, format] : kByName) {
    if (extension == known) {
      return format;
    }
  }
  return ScanFormat::kUnknown;
}

std::vector<ScanData> one(ScanData scan) {
  std::vector<ScanData> scans;
  scans.push_back(std::move(scan));
  return scans;
}

}  // namespace

Result<std::vector<ScanData>> read_scan_bytes(std::string_view bytes, const std::string& name,
                                              const GridReadOptions& options) {
  Result<ScanData> scan;
  switch (format_of(bytes, name)) {
    case ScanFormat::kPly:
      scan = read_ply_scan(bytes, name, options);
      break;
    case ScanFormat::kGrid: {
      Result<RangeGrid> grid = decode_grid(std::as_bytes(std::span(bytes)), name);
      if (!grid) {
        return std::unexpected(grid.error());
      }
      if (grid->source.empty()) {
        grid->source = file_name_of(name);
      }
      scan = std::move(*grid);
      break;
    }
    case ScanFormat::kPtx:
      return read_ptx(bytes, name, options);
    case ScanFormat::kPointText:
      scan = read_point_text(bytes, name, options);
      break;
    case ScanFormat::kUnknown:
      return bad_input(name, "not a scan that Dubsar reads", "give range-grid PLY, PTX, point text or .grid");
  }
  if (!scan) {
    return std::unexpected(scan.error());
  }
  return one(std::move(*scan));
}

Result<std::vector<ScanData>> read_scan_file(const std::filesystem::path& path,
                                             const GridReadOptions& options) {
  const Result<std::string> bytes = read_whole_file(path);
  if (!bytes) {
    return std::unexpected(bytes.error());
  }
  return read_scan_bytes(*bytes, path.string(), options);
}

bool looks_like_scan(const std::filesystem::path& path) {
  const Result<std::string> head = read_file_head(path, kHeadBytes);
  if (!head) {
    return false;
  }
  switch (format_of(*head, path)) {
    case ScanFormat::kPly: {
      const Result<PlyHeader> header = parse_ply_header(*head, path.string());
      // A PLY that cannot be made out is a scan that was damaged: leaving it out would hide that.
      return !header || is_scan_header(*header);
    }
    case ScanFormat::kGrid:
      return is_grid_file(*head);
    case ScanFormat::kPtx:
    case ScanFormat::kPointText:
      return is_point_text(*head);
    case ScanFormat::kUnknown:
      break;
  }
  return false;
}

Result<int> count_scans(const std::filesystem::path& path) {
  const Result<std::string> head = read_file_head(path, kHeadBytes);
  if (!head) {
    return std::unexpected(head.error());
  }
  if (format_of(*head, path) == ScanFormat::kPtx) {
    const Result<std::string> bytes = read_whole_file(path);
    return bytes ? count_ptx_scans(*bytes, path.string()) : std::unexpected(bytes.error());
  }
  if (!looks_like_scan(path)) {
    return bad_input(path.string(), "not a scan that Dubsar reads",
                     "give range-grid PLY, PTX, point text or .grid");
  }
  return 1;
}

}  // namespace dubsar
