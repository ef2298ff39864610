// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "core/job.h"
#include "core/result.h"

namespace dubsar {

enum class Sha2 { k256, k512 };

/// A checksum of the SHA-2 family (FIPS 180-4) over bytes that come piece by piece. The hashing is
/// libcrypto's.
class Sha2Sum {
 public:
  explicit Sha2Sum(Sha2 kind);
  void add(std::string_view bytes);
  /// 64 or 128 lower-case hexadecimal digits. Nothing may be added afterwards.
  [[nodiscard]] std::string hex();

 private:
  struct Free {
    void operator()(void* context) const;
  };
  std::unique_ptr<void, Free> context_;
};

[[nodiscard]] std::string sha2_hex(Sha2 kind, std::string_view bytes);
/// Errors: kBadInput when there is no such file, kStorage when it cannot be read to its end, kCancelled.
[[nodiscard]] Result<std::string> sha2_of_file(Sha2 kind, const std::filesystem::path& path,
                                               const JobContext& job);

[[nodiscard]] inline std::string sha256_hex(std::string_view bytes) {
  return sha2_hex(Sha2::k256, bytes);
}
[[nodiscard]] inline std::string sha512_hex(std::string_view bytes) {
  return sha2_hex(Sha2::k512, bytes);
}
[[nodiscard]] inline Result<std::string> sha256_of_file(const std::filesystem::path& path,
                                                        const JobContext& job) {
  return sha2_of_file(Sha2::k256, path, job);
}
[[nodiscard]] inline Result<std::string> sha512_of_file(const std::filesystem::path& path,
                                                        const JobContext& job) {
  return sha2_of_file(Sha2::k512, path, job);
}

}  // namespace dubsar
