// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/make_folder.h"

#include <cerrno>
#include <system_error>

namespace dubsar {

Status make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error) {
    return {};
  }
  const bool full = error.value() == ENOSPC || error.value() == EDQUOT;
  return fail(ErrorKind::kStorage, "cannot make the folder: " + error.message(), folder.string(),
              full ? "free some space on this disk" : "choose a folder that can be written to");
}

}  // namespace dubsar
