// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/session_name.h"

#include <system_error>

#include "core/utf8.h"

namespace dubsar {

std::filesystem::path whole_name(const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(folder, error);
  const std::filesystem::path whole = (error ? folder : absolute).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

std::string session_name(const std::filesystem::path& folder) {
  return one_line(whole_name(folder).filename().string());
}

}  // namespace dubsar
