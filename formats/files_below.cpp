// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/files_below.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

namespace dubsar {

namespace fs = std::filesystem;

namespace {

Error unreadable(const fs::path& path, const std::error_code& error) {
  return {ErrorKind::kStorage, error.message(), path.string(), "look at its rights and at the disk"};
}

}  // namespace

FoundBelow everything_below(const fs::path& folder, const PassesOver& passes_over) {
  FoundBelow found;
  std::vector<fs::path> to_list{folder};
  while (!to_list.empty()) {
    const fs::path listed = std::move(to_list.back());
    to_list.pop_back();
    if (const Status readable = check_folder_can_be_read(listed); !readable) {
      found.unreadable.push_back(readable.error());
      continue;
    }
    std::error_code error;
    fs::directory_iterator at(listed, error);
    for (const fs::directory_iterator end; !error && at != end; at.increment(error)) {
      if (passes_over && passes_over(at->path())) {
        continue;
      }
      std::error_code unknown;
      const bool is_folder = at->symlink_status(unknown).type() == fs::file_type::directory;
      (is_folder ? to_list : found.files).push_back(at->path());
    }
    const bool went_meanwhile = listed != folder && error == std::errc::no_such_file_or_directory;
    if (error && !went_meanwhile) {
      found.unreadable.push_back(unreadable(listed, error));
    }
  }
  std::ranges::sort(found.files);
  std::ranges::sort(found.unreadable, {}, &Error::where);
  return found;
}

FoundBelow readable_files_below(const fs::path& folder, const PassesOver& passes_over) {
  FoundBelow found = everything_below(folder, passes_over);
  std::erase_if(found.files, [&](const fs::path& path) {
    std::error_code unknown;
    const fs::file_status status = fs::status(path, unknown);
    if (unknown && status.type() != fs::file_type::not_found) {
      found.unreadable.push_back(unreadable(path, unknown));
    }
    return !fs::is_regular_file(status);
  });
  std::ranges::sort(found.unreadable, {}, &Error::where);
  return found;
}

Result<std::vector<fs::path>> files_below(const fs::path& folder, const PassesOver& passes_over) {
  FoundBelow found = readable_files_below(folder, passes_over);
  return found.unreadable.empty() ? Result<std::vector<fs::path>>(std::move(found.files))
                                  : std::unexpected(std::move(found.unreadable.front()));
}

Status check_folder_can_be_read(const fs::path& folder) {
  std::error_code error;
  const fs::directory_iterator listed(folder, error);
  if (error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory) {
    return {};
  }
  if (!error && ::faccessat(AT_FDCWD, folder.c_str(), X_OK, AT_EACCESS) != 0) {
    error.assign(errno, std::generic_category());
  }
  return error ? Status(fail(ErrorKind::kStorage, "cannot read the folder: " + error.message(),
                             folder.string(), "look at its rights and at the disk"))
               : Status();
}

}  // namespace dubsar
