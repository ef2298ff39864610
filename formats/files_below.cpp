// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/files_below.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace dubsar {

namespace fs = std::filesystem;

Result<std::vector<fs::path>> files_below(const fs::path& folder,
                                          const std::function<bool(const fs::path&)>& passes_over) {
  const auto unreadable = [](const fs::path& path, const std::error_code& error) {
    return fail(ErrorKind::kStorage, error.message(), path.string(), "look at its rights and at the disk");
  };
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (passes_over && passes_over(at->path())) {
      at.disable_recursion_pending();
      continue;
    }
    std::error_code unknown;  // of its own: going on to the next one forgets it
    const fs::file_status status = at->status(unknown);
    if (unknown && status.type() != fs::file_type::not_found) {
      return unreadable(at->path(), unknown);
    }
    if (fs::is_regular_file(status)) {
      files.push_back(at->path());
    }
  }
  if (error) {
    return unreadable(folder, error);
  }
  std::ranges::sort(files);
  return files;
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
