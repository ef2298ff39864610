// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/job.h"
#include "core/result.h"
#include "formats/digest.h"

namespace dubsar {

// The checksums that Dubsar itself goes by: 64 or 128 lower-case hexadecimal digits. Errors: those of
// digest_of_file().

[[nodiscard]] inline std::string sha256_hex(std::string_view bytes) {
  return digest_hex(Digest::kSha256, bytes);
}
[[nodiscard]] inline std::string sha512_hex(std::string_view bytes) {
  return digest_hex(Digest::kSha512, bytes);
}
[[nodiscard]] inline Result<std::string> sha256_of_file(const std::filesystem::path& path,
                                                        const JobContext& job) {
  return digest_of_file(Digest::kSha256, path, job);
}
[[nodiscard]] inline Result<std::string> sha512_of_file(const std::filesystem::path& path,
                                                        const JobContext& job) {
  return digest_of_file(Digest::kSha512, path, job);
}

}  // namespace dubsar
