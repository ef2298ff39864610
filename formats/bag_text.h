// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"

/// The text files of a BagIt bag (RFC 8493), as they come from anywhere.
namespace dubsar {

/// Larger text files of a bag are refused unread.
inline constexpr std::uint64_t kMaxBagTextBytes = std::uint64_t{256} << 20U;

/// bagit.txt
struct BagDeclaration {
  int major = 0;
  int minor = 0;
  [[nodiscard]] bool at_least(int a, int b) const { return std::pair(major, minor) >= std::pair(a, b); }
};
[[nodiscard]] Result<BagDeclaration> parse_bag_declaration(std::string_view text, const std::string& where);

struct BagManifestLine {
  std::string sum;       ///< lower-case hexadecimal digits
  std::string path;      ///< decoded, relative to the bag, without "." parts
  std::size_t line = 0;  ///< number in the manifest, from 1
};
/// A manifest. A path that is absolute or leads out of the bag is an error, as are one that stands there
/// twice and a line that is none.
[[nodiscard]] Result<std::vector<BagManifestLine>> parse_bag_manifest(std::string_view text,
                                                                      const BagDeclaration& declaration,
                                                                      const std::string& where);

/// The paths that fetch.txt says are to be fetched.
[[nodiscard]] Result<std::vector<std::string>> parse_bag_fetch(std::string_view text,
                                                               const BagDeclaration& declaration,
                                                               const std::string& where);

struct BagOxum {
  std::uint64_t bytes = 0;
  std::uint64_t files = 0;
  bool operator==(const BagOxum&) const = default;
};
/// Payload-Oxum of bag-info.txt: nothing when it is not given, an error when it is no oxum.
[[nodiscard]] Result<std::optional<BagOxum>> parse_bag_oxum(std::string_view bag_info,
                                                            const std::string& where);

/// The path of a bag from how it stands in a manifest: CR and LF percent-encoded, and from version 1.0 on %
/// itself.
[[nodiscard]] std::string decode_bag_path(std::string_view text, BagDeclaration declaration = {1, 0});

}  // namespace dubsar
