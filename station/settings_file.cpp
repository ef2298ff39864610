// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/settings_file.h"

#include "formats/atomic_file.h"
#include "formats/make_folder.h"

namespace dubsar {

Status write_settings_file(const std::filesystem::path& file, std::string_view text) {
  if (Status made = make_folder(folder_of(file)); !made) {
    return made;
  }
  return write_behind_link(file, text);
}

}  // namespace dubsar
