// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The rows of scans that were not over: no scan of the session yet, and measured all the same.

#include <fmt/format.h>

#include <cstdint>

#include "core/log.h"
#include "core/shell_word.h"
#include "formats/atomic_file.h"
#include "formats/files_below.h"
#include "formats/grid_file.h"
#include "station/package_content.h"
#include "station/unfinished_scan.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// What of one such scan was packed.
struct PackedRows {
  std::size_t files = 0;
  std::int64_t rows = 0;
};

/// Copies a file to the bit. One that is gone was stored as a scan meanwhile, or ended on purpose; one that
/// is damaged is told.
Status pack_file(PackageContent& content, const fs::path& file, const std::string& to, PackedRows& packed) {
  const Result<std::string> bytes = read_whole_file(file);
  std::error_code unknown;
  if (!bytes && !fs::exists(file, unknown) && !unknown) {
    return {};
  }
  const bool is_grid = file.extension() == ".grid";
  const Result<RangeGrid> grid =
      bytes && is_grid ? decode_grid(std::as_bytes(std::span(*bytes)), file.string()) : RangeGrid{};
  if (!bytes || !grid) {
    content.lacking.push_back(fmt::format("{} is not here, rows of a scan that was not over: {}.", to,
                                          bytes ? grid.error().what : bytes.error().what));
    return {};
  }
  const Result<fs::path> place = content.place(to);
  if (!place) {
    return std::unexpected(place.error());
  }
  ++packed.files;
  packed.rows += grid->rows;
  return write_file_atomically(*place, std::string_view(*bytes));
}

}  // namespace

Status add_unfinished(PackageContent& content) {
  std::int64_t rows = 0;
  for (const LeftScan& left : left_scans(content.store.folder())) {
    const fs::path& folder = left.folder;
    const std::string to = "scans/unfinished/" + folder.filename().string() + "/";
    const Result<std::vector<fs::path>> files = files_below(
        folder, [](const fs::path& file) { return file.filename().string().starts_with(kTemporaryPrefix); });
    if (!files) {
      content.lacking.push_back(
          fmt::format("{} is not here, rows of a scan that was not over: {}.", to, files.error().what));
      continue;
    }
    PackedRows packed;
    for (const fs::path& file : *files) {
      if (const Status done =
              pack_file(content, file, to + file.lexically_relative(folder).generic_string(), packed);
          !done) {
        return done;
      }
    }
    if (packed.files > 0) {
      content.list(to, fmt::format("{} rows of a scan that was not over when its program ended, as "
                                   "they came: it is in neither the list of scans nor model and verdict, "
                                   "until a program scans into the session again: formats/session.txt",
                                   packed.rows));
    }
    rows += packed.rows;
  }
  if (rows > 0) {
    log_warning(
        fmt::format("{} rows of a scan that was not over are packed as they are (scans/unfinished), "
                    "and are in neither model nor verdict: dubsar scan --session {} takes them in",
                    rows, shell_word(content.store.folder().string())));
  }
  return {};
}

}  // namespace dubsar
