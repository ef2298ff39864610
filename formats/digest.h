// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/job.h"
#include "core/result.h"

namespace dubsar {

/// Checksums of FIPS 180-4 and, for bags of others that have no better one, MD5 (RFC 1321) and SHA-1: these
/// two tell accidents, and nobody who means harm.
enum class Digest { kMd5, kSha1, kSha224, kSha256, kSha384, kSha512 };

/// By the name that the manifests of bags have ("md5", "sha512"). Nothing where it is another one, or where
/// the system's libcrypto does not do it.
[[nodiscard]] std::optional<Digest> digest_named(std::string_view name);

/// A checksum over bytes that come piece by piece. The hashing is libcrypto's.
class DigestSum {
 public:
  explicit DigestSum(Digest kind);
  void add(std::string_view bytes);
  /// Lower-case hexadecimal digits. Nothing may be added afterwards.
  [[nodiscard]] std::string hex();

 private:
  struct Free {
    void operator()(void* context) const;
  };
  std::unique_ptr<void, Free> context_;
};

[[nodiscard]] std::string digest_hex(Digest kind, std::string_view bytes);
/// Errors: kBadInput when there is no such file, kStorage when it cannot be read to its end, kCancelled.
[[nodiscard]] Result<std::string> digest_of_file(Digest kind, const std::filesystem::path& path,
                                                 const JobContext& job);

}  // namespace dubsar
