// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/session_files.h"

#include <xxhash.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <sstream>

#include "formats/atomic_file.h"
#include "formats/make_folder.h"
#include "formats/refusal.h"
#include "formats/same_bytes.h"

namespace dubsar::session {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kPieceBytes = std::size_t{1} << 20U;

std::unexpected<Error> refused(const fs::path& path, const char* doing, int error) {
  return dubsar::refused(path, doing, error, "choose a folder that can be written to");
}

struct StateFreer {
  void operator()(XXH64_state_t* state) const { XXH64_freeState(state); }
};

}  // namespace

bool in_a_folder_of_the_session(const fs::path& name) {
  return !name.empty() && name.is_relative() && std::ranges::find(name, fs::path("..")) == name.end() &&
         std::ranges::any_of(kFolders, [&](const char* folder) { return *name.begin() == folder; });
}

Status make_folders(const fs::path& folder) {
  std::error_code error;
  const bool there = fs::exists(folder, error);
  if (there && !fs::is_directory(folder, error)) {
    return fail(ErrorKind::kUsage, "not a folder", folder.string(), "name a folder for the session");
  }
  bool ours = false;
  for (const char* name : {kDatabase, kGrids, kBackup}) {
    ours = ours || fs::exists(folder / name, error);
    if (there && error) {
      return refused(folder, "cannot read the folder", error.value());
    }
  }
  if (there && !ours) {
    fs::directory_iterator it(folder, error);
    if (error) {
      return refused(folder, "cannot read the folder", error.value());
    }
    // A store that was killed while it made its first folders leaves its lock alone.
    const bool foreign = std::any_of(it, fs::directory_iterator(), [](const fs::directory_entry& entry) {
      return entry.path().filename() != kLock;
    });
    if (foreign) {
      return fail(ErrorKind::kUsage, "the folder holds other things and no session", folder.string(),
                  "name a new or an empty folder");
    }
  }
  if (Status made = make_folder(folder); !made) {
    return made;
  }
  for (const char* name : kFolders) {
    fs::create_directory(folder / name, error);
    if (error) {
      return refused(folder / name, "cannot make the folder", error.value());
    }
  }
  return sync_folder(folder);
}

int remove_temporaries(const fs::path& folder) {
  int removed = 0;
  std::vector<fs::path> places{folder};
  for (const char* name : kFolders) {
    places.push_back(folder / name);
  }
  for (const fs::path& place : places) {
    std::error_code ignored;
    std::vector<fs::path> found;
    for (fs::directory_iterator it(place, ignored), end; !ignored && it != end; it.increment(ignored)) {
      if (it->path().filename().string().starts_with(kTemporaryPrefix)) {
        found.push_back(it->path());
      }
    }
    for (const fs::path& path : found) {
      removed += fs::remove(path, ignored) ? 1 : 0;
    }
  }
  return removed;
}

std::string grid_name(int id) {
  std::string digits = std::to_string(id);
  digits.insert(0, digits.size() < 3 ? 3 - digits.size() : 0, '0');
  return std::string(kGrids) + "/" + digits + ".grid";
}

std::vector<int> grid_ids(const fs::path& folder) {
  std::vector<int> out;
  std::error_code ignored;
  for (fs::directory_iterator it(folder / kGrids, ignored), end; !ignored && it != end;
       it.increment(ignored)) {
    const std::string stem = it->path().stem().string();
    int id = -1;
    const auto [rest, problem] = std::from_chars(stem.data(), stem.data() + stem.size(), id);
    if (problem == std::errc{} && rest == stem.data() + stem.size() && id >= 0 && id <= kLastScanId &&
        it->path().filename() == fs::path(grid_name(id)).filename()) {
      out.push_back(id);
    }
  }
  std::ranges::sort(out);
  return out;
}

std::int64_t hash_of(std::string_view bytes) {
  return static_cast<std::int64_t>(XXH64(bytes.data(), bytes.size(), 0));
}

Result<FileSum> sum_of_file(const fs::path& path, const JobContext* job) {
  Result<std::ifstream> file = open_stored_file(path);
  if (!file) {
    return std::unexpected(file.error());
  }
  const std::unique_ptr<XXH64_state_t, StateFreer> state(XXH64_createState());
  XXH64_reset(state.get(), 0);
  // Most files of a session are small: clearing a whole piece for each took longer than reading it.
  std::error_code unknown;
  const std::uintmax_t size = fs::file_size(path, unknown);
  std::vector<char> piece(unknown ? kPieceBytes : std::min<std::uintmax_t>(kPieceBytes, size + 1));
  FileSum sum;
  while (*file) {
    if (job != nullptr && job->cancelled()) {
      return fail(ErrorKind::kCancelled, "verification cancelled");
    }
    file->read(piece.data(), static_cast<std::streamsize>(piece.size()));
    const auto got = static_cast<std::size_t>(file->gcount());
    XXH64_update(state.get(), piece.data(), got);
    sum.bytes += static_cast<std::int64_t>(got);
  }
  if (file->bad()) {
    return fail(ErrorKind::kStorage, "cannot be read to its end", path.string(), "check the disk");
  }
  sum.hash = static_cast<std::int64_t>(XXH64_digest(state.get()));
  return sum;
}

Result<Sums> parse_sums(std::string_view text, const std::string& where) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string body(text.substr(std::min(end + 1, text.size())));
  if (text.substr(0, end) != std::to_string(hash_of(body))) {
    return bad_input(where, "the list of checksums is damaged",
                     "open the session for writing to have it made anew");
  }
  Sums out;
  std::istringstream lines(body);
  FileSum sum;
  for (std::string name; lines >> sum.hash >> sum.bytes >> name;) {
    out.emplace(name, sum);
  }
  return out;
}

std::string text_of_sums(const Sums& sums) {
  std::ostringstream body;
  for (const auto& [name, sum] : sums) {
    body << sum.hash << ' ' << sum.bytes << ' ' << name << '\n';
  }
  return std::to_string(hash_of(body.view())) + "\n" + body.str();
}

Result<Sums> read_sums(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder / kSums, error)) {
    return Sums();
  }
  const Result<std::string> text = read_whole_file(folder / kSums, 4096);
  return text ? parse_sums(*text, (folder / kSums).string()) : std::unexpected(text.error());
}

Status write_sums(const fs::path& folder, const Sums& sums) {
  return write_file_atomically(folder / kSums, text_of_sums(sums));
}

Status take_sum_away(const fs::path& folder, Sums sums) {
  return sums.erase(kDatabase) > 0 ? write_sums(folder, sums) : Status();
}

bool is_set_aside(const fs::path& path) {
  return std::ranges::any_of(path, [](const fs::path& part) {
    const std::string name = part.string();
    return name.find(kAsideMark) != std::string::npos || name.find(kBeforeMark) != std::string::npos;
  });
}

fs::path name_aside(const fs::path& path, const char* mark) {
  std::error_code ignored;
  for (int i = 1;; ++i) {
    fs::path name = path.string() + mark + std::to_string(i);
    if (!fs::exists(fs::symlink_status(name, ignored))) {
      return name;
    }
  }
}

Result<fs::path> move_aside(const fs::path& path) {
  fs::path aside = name_aside(path);
  std::error_code error;
  fs::rename(path, aside, error);
  if (error) {
    return fail(ErrorKind::kStorage, "cannot set what is damaged aside: " + error.message(), path.string(),
                "see that the folder may be written to");
  }
  if (Status synced = sync_folder(path.parent_path()); !synced) {
    return std::unexpected(std::move(synced.error()));
  }
  return aside;
}

Result<fs::path> copy_aside(const fs::path& path, const char* mark) {
  std::error_code ignored;
  for (int i = 1; fs::exists(path.string() + mark + std::to_string(i), ignored); ++i) {
    fs::path kept = path.string() + mark + std::to_string(i);
    if (!fs::is_symlink(kept, ignored) && have_same_bytes(path, kept)) {
      return kept;
    }
  }
  const Result<std::string> bytes = read_whole_file(path);
  if (!bytes) {
    return move_aside(path);  // which needs no reading
  }
  fs::path aside = name_aside(path, mark);
  if (Status kept = write_file_atomically(aside, std::string_view(*bytes)); !kept) {
    return std::unexpected(kept.error());
  }
  return aside;
}

}  // namespace dubsar::session
