// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/same_bytes.h"

namespace dubsar {

bool have_same_bytes(const std::filesystem::path& a, const std::filesystem::path& b,
                     std::uint64_t limit_bytes) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(a, error);
  if (error || std::filesystem::file_size(b, error) != bytes || error) {
    return false;
  }
  const Result<std::string> of_a = read_whole_file(a, limit_bytes);
  const Result<std::string> of_b = read_whole_file(b, limit_bytes);
  return of_a && of_b && *of_a == *of_b;
}

}  // namespace dubsar
