// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/job.h"
#include "core/result.h"

/// The files of a session folder below the level of SessionStore.
namespace dubsar::session {

inline constexpr const char* kDatabase = "session.sqlite";
inline constexpr const char* kBackup = "session.backup.sqlite";
inline constexpr const char* kSums = "session.sums";
inline constexpr const char* kLock = "session.lock";
inline constexpr const char* kGrids = "grids";
inline constexpr const char* kFolders[] = {kGrids, "mesh", "analysis", "export"};

/// True for a name below one of those folders. What the tables name is untrusted: it may lead elsewhere.
[[nodiscard]] bool in_a_folder_of_the_session(const std::filesystem::path& name);

/// Makes the session's folders, durably. Refuses a folder that holds other things and no session.
[[nodiscard]] Status make_folders(const std::filesystem::path& folder);
/// Removes what a killed writer left behind half-written; returns how many.
int remove_temporaries(const std::filesystem::path& folder);

/// The last number that a scan can have: eight digits, as those of scans that are not over.
inline constexpr int kLastScanId = 99'999'999;
/// "grids/007.grid"
[[nodiscard]] std::string grid_name(int id);
/// The ids of the grid files that are there, ascending, up to kLastScanId.
[[nodiscard]] std::vector<int> grid_ids(const std::filesystem::path& folder);

/// XXH64 of bytes, as SQLite keeps it.
[[nodiscard]] std::int64_t hash_of(std::string_view bytes);

struct FileSum {
  std::int64_t bytes = 0;
  std::int64_t hash = 0;
  bool operator==(const FileSum&) const = default;
};
/// Reads a file once, in pieces.
[[nodiscard]] Result<FileSum> sum_of_file(const std::filesystem::path& path, const JobContext* job = nullptr);

/// In place of the sum of a file that is about to be written for the first time.
inline constexpr FileSum kNotThereYet{};

/// By name. A name has two sums while its file is being replaced: either is whole.
using Sums = std::multimap<std::string, FileSum>;
/// session.sums: what the database and its backup looked like when they were last closed.
/// Empty without that file; an error when it does not match the checksum that it begins with.
[[nodiscard]] Result<Sums> read_sums(const std::filesystem::path& folder);
[[nodiscard]] Result<Sums> parse_sums(std::string_view text, const std::string& where);
[[nodiscard]] std::string text_of_sums(const Sums& sums);
[[nodiscard]] Status write_sums(const std::filesystem::path& folder, const Sums& sums);
/// Once something is written the old checksum of the database is wrong; the backup's stays good.
[[nodiscard]] Status take_sum_away(const std::filesystem::path& folder, Sums sums);

/// Damaged originals are kept beside what takes their place, as NAME.damaged-1, -2, …; so is a folder that
/// one lies in.
inline constexpr const char* kAsideMark = ".damaged-";
/// In place of it, of what was whole and had to be replaced in a mend.
inline constexpr const char* kBeforeMark = ".before-";
[[nodiscard]] bool is_set_aside(const std::filesystem::path& path);
/// The first such name that is free.
[[nodiscard]] std::filesystem::path name_aside(const std::filesystem::path& path,
                                               const char* mark = kAsideMark);
/// Moves a damaged file, or a folder with one, to its name aside, durably, and returns that name.
[[nodiscard]] Result<std::filesystem::path> move_aside(const std::filesystem::path& path);
/// Copies a damaged file to its name aside, durably, and returns that name; the file itself stays. Where the
/// same bytes lie aside already, that is their name. What cannot be read is moved there.
[[nodiscard]] Result<std::filesystem::path> copy_aside(const std::filesystem::path& path,
                                                       const char* mark = kAsideMark);

}  // namespace dubsar::session
