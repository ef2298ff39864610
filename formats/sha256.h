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

/// SHA-256 (FIPS 180-4) of bytes that come in pieces: what `sha256sum` prints, so that a sign-off can be
/// checked without this program.
class Sha256 {
 public:
  void add(std::string_view bytes);
  /// 64 lower-case hexadecimal digits. Nothing may be added afterwards.
  [[nodiscard]] std::string hex();

 private:
  void block(const std::uint8_t* bytes);

  std::array<std::uint32_t, 8> state_{0x6a09e667U, 0xbb67ae85U, 0x3c6ef372U, 0xa54ff53aU,
                                      0x510e527fU, 0x9b05688cU, 0x1f83d9abU, 0x5be0cd19U};
  std::array<std::uint8_t, 64> waiting_{};
  std::size_t waiting_count_ = 0;
  std::uint64_t total_bytes_ = 0;
};

[[nodiscard]] std::string sha256_hex(std::string_view bytes);
/// Reads a file once, in pieces. Errors: kBadInput when it is not there, kStorage, kCancelled.
[[nodiscard]] Result<std::string> sha256_of_file(const std::filesystem::path& path, const JobContext& job);

}  // namespace dubsar
