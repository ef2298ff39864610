// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/job.h"
#include "core/result.h"

namespace dubsar {

/// SHA-512 (FIPS 180-4) of bytes that come in pieces: what `sha512sum` prints, and what the
/// manifests of a bag hold.
class Sha512 {
 public:
  void add(std::string_view bytes);
  /// 128 lower-case hexadecimal digits. Nothing may be added afterwards.
  [[nodiscard]] std::string hex();

 private:
  void block(const std::uint8_t* bytes);

  std::array<std::uint64_t, 8> state_{0x6a09e667f3bcc908U, 0xbb67ae8584caa73bU, 0x3c6ef372fe94f82bU,
                                      0xa54ff53a5f1d36f1U, 0x510e527fade682d1U, 0x9b05688c2b3e6c1fU,
                                      0x1f83d9abfb41bd6bU, 0x5be0cd19137e2179U};
  std::array<std::uint8_t, 128> waiting_{};
  std::size_t waiting_count_ = 0;
  std::uint64_t total_bytes_ = 0;
};

[[nodiscard]] std::string sha512_hex(std::string_view bytes);
/// Reads a file once, in pieces. Errors: kBadInput when it is not there, kStorage, kCancelled.
[[nodiscard]] Result<std::string> sha512_of_file(const std::filesystem::path& path, const JobContext& job);

}  // namespace dubsar
