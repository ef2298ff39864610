// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/session_links.h"

#include <iterator>
#include <vector>

#include "acquisition/session_files.h"
#include "formats/atomic_file.h"

namespace dubsar::session {

namespace fs = std::filesystem;

std::optional<Error> link_on_the_way(const fs::path& session, const fs::path& name) {
  fs::path part;
  for (const fs::path& one : name) {
    part /= one;
    std::error_code ignored;
    if (fs::is_symlink(session / part, ignored)) {
      return Error{ErrorKind::kBadInput, "a link, which is not followed", part.generic_string(),
                   "put what it leads to in its place"};
    }
  }
  return std::nullopt;
}

Status take_tables_apart(const fs::path& session) {
  const std::string tables = (session / kDatabase).string();
  const auto is_shared = [](const fs::path& file) {
    std::error_code none;
    return fs::is_regular_file(fs::symlink_status(file, none)) && fs::hard_link_count(file, none) > 1 &&
           !none;
  };
  for (const char* suffix : {"-wal", ""}) {
    const fs::path file = tables + suffix;
    if (!is_shared(file)) {
      continue;
    }
    const Result<std::string> bytes = read_whole_file(file);
    if (!bytes) {
      return std::unexpected(bytes.error());
    }
    if (Status written = write_file_atomically(file, std::string_view(*bytes)); !written) {
      return written;
    }
  }
  // Made anew from the log by whoever opens it.
  if (const fs::path index = tables + "-shm"; is_shared(index)) {
    std::error_code ignored;
    fs::remove(index, ignored);
  }
  return {};
}

Status check_written_names_are_no_links(const fs::path& session) {
  std::vector<const char*> written(std::begin(kFolders), std::end(kFolders));
  written.insert(written.end(), {kDatabase, kBackup, kSums});  // the lock looks for itself
  const std::string log = std::string(kDatabase) + "-wal";
  const std::string index = std::string(kDatabase) + "-shm";
  written.insert(written.end(), {log.c_str(), index.c_str()});
  for (const char* name : written) {
    if (const auto link = link_on_the_way(session, name)) {
      return fail(link->kind, link->what, (session / link->where).string(), link->mend);
    }
  }
  for (const std::string& name : {log, index}) {
    std::error_code ignored;
    const fs::file_status is = fs::status(session / name, ignored);
    if (fs::exists(is) && !fs::is_regular_file(is)) {
      return bad_input((session / name).string(), "no file: nothing is written to it", "take it away");
    }
  }
  return {};
}

}  // namespace dubsar::session
