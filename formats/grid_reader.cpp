// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/grid_reader.h"

#include <algorithm>
#include <array>
#include <span>

#include "core/lower_case.h"
#include "formats/atomic_file.h"
#include "formats/grid_file.h"
#include "formats/ply_header.h"
#include "formats/ply_scan.h"
#include "formats/scan_samples.h"
#include "formats/stoppable_read.h"
#include "formats/text_scanner.h"
#include "formats/text_scans.h"

namespace dubsar {

namespace {

enum class ScanFormat { kPly, kGrid, kPtx, kPointText, kUnknown };

/// Enough for any header that anyone writes.
constexpr std::size_t kHeadBytes = std::size_t{64} << 10U;

/// What the bytes say, then what the name says.
ScanFormat format_of(std::string_view bytes, const std::filesystem::path& name) {
  const std::string extension = in_lower_case(name.extension().string());
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

bool is_txt(const std::filesystem::path& name) {
  return in_lower_case(name.extension().string()) == ".txt";
}

/// A .txt may be anything; what has an ending of points is damaged where it holds none, unless it is a
/// signature.
FileKind kind_of_text(std::string_view head, bool whole, const std::filesystem::path& name) {
  const bool txt = is_txt(name);
  if (TextScanner(head).at_end()) {
    return txt ? FileKind::kDoubtful : FileKind::kScan;
  }
  if (head.starts_with("-----BEGIN PGP")) {
    return FileKind::kOther;
  }
  const std::size_t points = count_point_lines(head);
  if (points >= kLeastPointLines || (!txt && (points == 0 || !whole))) {
    return FileKind::kScan;
  }
  return points > 0 ? FileKind::kFewPoints : FileKind::kOther;
}

/// What only the name tells of.
FileKind kind_of_unread(const std::filesystem::path& name) {
  const ScanFormat format = format_of({}, name);
  return format == ScanFormat::kUnknown ? FileKind::kOther
         : is_txt(name)                 ? FileKind::kDoubtful
                                        : FileKind::kScan;
}

std::unexpected<Error> no_scan(const std::filesystem::path& name) {
  const bool table = in_lower_case(name.extension().string()) == ".csv";
  return bad_input(name.string(), "not a scan that Dubsar reads",
                   has_packed_name(name) ? "unpack the packed files"
                   : table               ? "rename .csv to .xyz where the lines are points"
                                         : "give range-grid PLY, PTX, point text or .grid");
}

std::vector<ScanData> one(ScanData scan) {
  std::vector<ScanData> scans;
  scans.push_back(std::move(scan));
  return scans;
}

}  // namespace

bool has_packed_name(const std::filesystem::path& name) {
  constexpr std::array<std::string_view, 7> kPacked{".gz", ".zip", ".7z", ".bz2", ".xz", ".zst", ".rar"};
  return std::ranges::find(kPacked, in_lower_case(name.extension().string())) != kPacked.end();
}

Result<std::vector<ScanData>> read_scan_bytes(std::string_view bytes, const std::string& name,
                                              const GridReadOptions& options) {
  bytes = without_byte_order_mark(bytes);
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
      return no_scan(name);
  }
  if (!scan) {
    return std::unexpected(scan.error());
  }
  return one(std::move(*scan));
}

Result<std::vector<ScanData>> read_scan_file(const std::filesystem::path& path,
                                             const GridReadOptions& options) {
  const Result<std::string> bytes = read_whole_file_unless_stopped(path, options.job);
  if (!bytes) {
    std::error_code ignored;
    return std::filesystem::is_symlink(path, ignored) && !std::filesystem::exists(path, ignored)
               ? bad_input(path.string(), "a link to a file that is not there", "copy the file itself here")
               : std::unexpected(bytes.error());
  }
  return read_scan_bytes(*bytes, path.string(), options);
}

FileKind kind_of_head(std::string_view head, bool whole, const std::filesystem::path& name) {
  head = without_byte_order_mark(head);
  switch (format_of(head, name)) {
    case ScanFormat::kPly: {
      const Result<PlyHeader> header = parse_ply_header(head, name.string());
      // A PLY that cannot be made out is a scan that was damaged.
      return !header || is_scan_header(*header) ? FileKind::kScan : FileKind::kOther;
    }
    case ScanFormat::kGrid:
    case ScanFormat::kPtx:
      return FileKind::kScan;
    case ScanFormat::kPointText:
      return kind_of_text(head, whole, name);
    case ScanFormat::kUnknown:
      break;
  }
  return FileKind::kOther;
}

FileKind kind_of_file(const std::filesystem::path& path) {
  std::error_code unreadable;
  const std::filesystem::file_type type = std::filesystem::status(path, unreadable).type();
  const bool missing = type == std::filesystem::file_type::not_found;
  if (missing && !std::filesystem::is_symlink(path, unreadable)) {
    return FileKind::kOther;
  }
  if (!missing && type != std::filesystem::file_type::none && type != std::filesystem::file_type::regular) {
    return FileKind::kOther;
  }
  const Result<std::string> head = read_file_head(path, kHeadBytes);
  return head ? kind_of_head(*head, head->size() < kHeadBytes, path) : kind_of_unread(path);
}

bool looks_like_scan(const std::filesystem::path& path) {
  return kind_of_file(path) == FileKind::kScan;
}

Result<int> count_scans(const std::filesystem::path& path) {
  const Result<std::string> head = read_file_head(path, kHeadBytes);
  if (!head) {
    return std::unexpected(head.error());
  }
  if (format_of(without_byte_order_mark(*head), path) == ScanFormat::kPtx) {
    const Result<std::string> bytes = read_whole_file(path);
    return bytes ? count_ptx_scans(without_byte_order_mark(*bytes), path.string())
                 : std::unexpected(bytes.error());
  }
  if (const FileKind kind = kind_of_file(path); kind == FileKind::kOther || kind == FileKind::kDoubtful) {
    return no_scan(path);
  }
  return 1;
}

}  // namespace dubsar
