// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/analysed_files.h"

#include <sys/stat.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "acquisition/session_store.h"
#include "formats/bag_check.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

constexpr const char* kWedges = "wedges.json";
constexpr std::string_view kResults = ".results";

/// NAME.kept-N, NAME.damaged-N.
bool is_kept_aside(const std::string& name) {
  for (const std::string_view mark : {".kept-", ".damaged-"}) {
    const std::size_t at = name.rfind(mark);
    if (at != std::string::npos && at + mark.size() < name.size() &&
        name.find_first_not_of("0123456789", at + mark.size()) == std::string::npos) {
      return true;
    }
  }
  return false;
}

bool is_file(const fs::path& path) {
  std::error_code none;
  return fs::is_regular_file(path, none);
}

/// Whether it is SESSION.results, beside that session.
bool comes_of_a_session(const fs::path& folder) {
  const std::string name = folder.filename().string();
  return name.size() > kResults.size() && name.ends_with(kResults) &&
         SessionStore::is_session(folder.parent_path() / name.substr(0, name.size() - kResults.size()));
}

/// Of a session. Not where nobody can see whether it is there.
bool lacks_database(const fs::path& session) {
  std::error_code unknown;
  return !fs::exists(session / "session.sqlite", unknown) && !unknown;
}

class Walk {
 public:
  explicit Walk(fs::path root) : root_(std::move(root)) {}

  /// Why the folder itself could not be read.
  std::optional<std::string> go() {
    if (std::optional<std::string> unread = look_into(root_)) {
      return unread;
    }
    // What lies in the folder itself comes before what a link leads to.
    for (std::size_t k = 0; k < linked_folders_.size(); ++k) {
      visit(fs::path(linked_folders_[k]));  // a copy: more may come to the list
    }
    for (const fs::path& file : linked_files_) {
      take(file);
    }
    std::ranges::sort(files_.paths);
    std::ranges::sort(files_.unread, {}, &UnreadPlace::name);
    std::ranges::sort(files_.lost_sessions);
    return std::nullopt;
  }
  AnalysedFiles&& files() && { return std::move(files_); }

 private:
  bool is_new(const fs::path& path) {
    struct stat status {};
    return ::stat(path.c_str(), &status) != 0 || seen_.emplace(status.st_dev, status.st_ino).second;
  }

  void take(const fs::path& file) {
    if (is_new(file)) {
      files_.paths.push_back(file);
    }
  }

  void not_read(const fs::path& path, std::string reason) {
    files_.unread.push_back({path.lexically_relative(root_).string(), std::move(reason)});
  }

  void visit(const fs::path& folder) {
    if (is_kept_aside(folder.filename().string()) || is_bag(folder) || comes_of_a_session(folder)) {
      return;
    }
    if (!SessionStore::is_session(folder)) {
      if (std::optional<std::string> unread = look_into(folder)) {
        not_read(folder, *std::move(unread));
      }
    } else if (is_new(folder)) {
      fs::path results = folder;
      results += kResults;
      const fs::path beside = results / kWedges;
      const fs::path within = folder / "analysis" / kWedges;
      if (is_file(beside)) {
        take(beside);
      } else if (is_file(within)) {
        take(within);
      } else if (lacks_database(folder)) {
        files_.lost_sessions.push_back(folder.lexically_relative(root_).string());
      }
    }
  }

  /// Why it could not be read, or not to its end.
  std::optional<std::string> look_into(const fs::path& folder) {
    if (!is_new(folder)) {
      return std::nullopt;
    }
    std::error_code error;
    std::vector<fs::directory_entry> entries;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
      if (!it->path().filename().string().starts_with('.')) {
        entries.push_back(*it);
      }
    }
    std::ranges::sort(entries, {}, [](const fs::directory_entry& entry) { return entry.path(); });
    const bool has_mesh = is_file(folder / "tablet.ply") || is_file(folder / "model.ply");
    const bool one_alone = has_mesh && is_file(folder / kWedges);
    for (const fs::directory_entry& entry : entries) {
      look_at(entry, one_alone);
    }
    return error ? std::optional(error.message()) : std::nullopt;
  }

  void look_at(const fs::directory_entry& entry, bool one_alone) {
    std::error_code error;
    const bool is_link = entry.is_symlink(error);
    const fs::file_status status = entry.status(error);
    const std::string name = entry.path().filename().string();
    if (!fs::status_known(status)) {
      not_read(entry.path(), error.message());
    } else if (fs::is_directory(status)) {
      if (is_link) {
        linked_folders_.push_back(entry.path());
      } else {
        visit(entry.path());
      }
    } else if (fs::is_regular_file(status) && entry.path().extension() == ".json" && name != "truth.json" &&
               (!one_alone || name == kWedges)) {
      if (is_link) {
        linked_files_.push_back(entry.path());
      } else {
        take(entry.path());
      }
    }
  }

  fs::path root_;
  AnalysedFiles files_;
  std::vector<fs::path> linked_folders_, linked_files_;
  std::set<std::pair<dev_t, ino_t>> seen_;  ///< folders gone through and files taken
};

}  // namespace

Result<AnalysedFiles> analysed_files(const fs::path& folder) {
  Walk walk(folder);
  if (const std::optional<std::string> unread = walk.go()) {
    return bad_input(folder.string(), "cannot read the folder: " + *unread, "check the name");
  }
  return std::move(walk).files();
}

}  // namespace dubsar
