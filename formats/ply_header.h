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

namespace dubsar {

/// The largest header that is read; real ones hold under a kilobyte.
inline constexpr std::size_t kMaxPlyHeaderBytes = std::size_t{1} << 20U;
inline constexpr std::size_t kMaxPlyElements = 64;
inline constexpr std::size_t kMaxPlyProperties = 256;  ///< of one element

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };
enum class PlyType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

[[nodiscard]] std::size_t size_of(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  std::optional<PlyType> count_type;  ///< set when the property is a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;  ///< as claimed; PlyBody checks it against the bytes that are there
  std::vector<PlyProperty> properties;

  /// Position of the scalar property of that name, or -1.
  [[nodiscard]] int scalar(std::string_view property) const;
  /// Position of the first list property, or -1.
  [[nodiscard]] int first_list() const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;                       ///< in file order
  std::vector<std::pair<std::string, std::string>> info;  ///< obj_info lines: first word, rest
  std::size_t body_offset = 0;

  [[nodiscard]] const PlyElement* element(std::string_view name) const;
  /// The rest of the first obj_info line that begins with that word.
  [[nodiscard]] std::optional<std::string_view> info_value(std::string_view key) const;
};

/// True when the bytes begin as a PLY file does, or so behind a byte order mark.
[[nodiscard]] bool is_ply(std::string_view bytes);

/// Parses the header (Turk 1994). Lines with a keyword that the format does not know are passed over. Names
/// come in small letters, however they are written. CRLF is taken for LF. Errors name the header line.
[[nodiscard]] Result<PlyHeader> parse_ply_header(std::string_view bytes, const std::string& where);
/// Whether these bytes, or the first of a file, are a PLY's whose header says its unit (ply_info::kUnit).
[[nodiscard]] bool states_unit(std::string_view bytes, const std::string& where);

}  // namespace dubsar
