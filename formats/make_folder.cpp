// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/make_folder.h"

#include <system_error>

#include "formats/refusal.h"

namespace dubsar {

Status make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error) {
    return {};
  }
  return refused(folder, "cannot make the folder", error.value(), "choose a folder that can be written to");
}

}  // namespace dubsar
