// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/ply_header.h"

#include <array>

#include "core/lower_case.h"
#include "formats/ply_scan_info.h"
#include "formats/text_scanner.h"

namespace dubsar {

namespace {

constexpr const char* kExportAgain = "export it again";

std::optional<PlyType> type_named(std::string_view word) {
  constexpr std::array<std::pair<std::string_view, PlyType>, 16> kNames{{
      {"char", PlyType::kInt8},
      {"int8", PlyType::kInt8},
      {"uchar", PlyType::kUint8},
      {"uint8", PlyType::kUint8},
      {"short", PlyType::kInt16},
      {"int16", PlyType::kInt16},
      {"ushort", PlyType::kUint16},
      {"uint16", PlyType::kUint16},
      {"int", PlyType::kInt32},
      {"int32", PlyType::kInt32},
      {"uint", PlyType::kUint32},
      {"uint32", PlyType::kUint32},
      {"float", PlyType::kFloat32},
      {"float32", PlyType::kFloat32},
      {"double", PlyType::kFloat64},
      {"float64", PlyType::kFloat64},
  }};
  for (const auto& [name, type] : kNames) {
    if (word == name) {
      return type;
    }
  }
  return std::nullopt;
}

/// What is wrong with one header line, or nothing.
using Complaint = std::optional<std::string>;

Complaint read_format(std::string_view rest, PlyHeader& header) {
  const std::string_view word = take_word(rest);
  if (word == "ascii") {
    header.format = PlyFormat::kAscii;
  } else if (word == "binary_little_endian") {
    header.format = PlyFormat::kLittleEndian;
  } else if (word == "binary_big_endian") {
    header.format = PlyFormat::kBigEndian;
  } else {
    return "format " + in_quotes(word) + " is not known";
  }
  return std::nullopt;
}

Complaint read_element(std::string_view rest, PlyHeader& header) {
  const std::string name = in_lower_case(std::string(take_word(rest)));
  const std::string_view count_word = take_word(rest);
  std::int64_t count = 0;
  if (name.empty() || !parse_integer(count_word, count)) {
    return "element " + in_quotes(name) + " has no count but " + in_quotes(count_word);
  }
  if (count < 0) {
    return "element " + in_quotes(name) + " has the negative count " + std::to_string(count);
  }
  if (header.element(name) != nullptr) {
    return "element " + in_quotes(name) + " stands twice";
  }
  if (header.elements.size() == kMaxPlyElements) {
    return "more than " + std::to_string(kMaxPlyElements) + " elements";
  }
  header.elements.push_back({name, static_cast<std::uint64_t>(count), {}});
  return std::nullopt;
}

Complaint read_property(std::string_view rest, PlyHeader& header) {
  if (header.elements.empty()) {
    return "a property stands before any element";
  }
  std::vector<PlyProperty>& properties = header.elements.back().properties;
  if (properties.size() == kMaxPlyProperties) {
    return "more than " + std::to_string(kMaxPlyProperties) + " properties in one element";
  }
  PlyProperty property;
  std::string_view word = take_word(rest);
  if (word == "list") {
    word = take_word(rest);
    property.count_type = type_named(word);
    if (!property.count_type || *property.count_type >= PlyType::kFloat32) {
      return "list length type " + in_quotes(word) + " is no whole-number type";
    }
    word = take_word(rest);
  }
  const std::optional<PlyType> type = type_named(word);
  if (!type) {
    return "property type " + in_quotes(word) + " is not known";
  }
  property.type = *type;
  property.name = in_lower_case(std::string(take_word(rest)));
  if (property.name.empty()) {
    return "a property has no name";
  }
  properties.push_back(std::move(property));
  return std::nullopt;
}

}  // namespace

std::size_t size_of(PlyType type) {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

int PlyElement::scalar(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (!properties[i].count_type && properties[i].name == property) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

int PlyElement::first_list() const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].count_type) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

const PlyElement* PlyHeader::element(std::string_view name) const {
  for (const PlyElement& candidate : elements) {
    if (candidate.name == name) {
      return &candidate;
    }
  }
  return nullptr;
}

std::optional<std::string_view> PlyHeader::info_value(std::string_view key) const {
  for (const auto& [name, value] : info) {
    if (name == key) {
      return value;
    }
  }
  return std::nullopt;
}

bool is_ply(std::string_view bytes) {
  bytes = without_byte_order_mark(bytes);
  return bytes.starts_with("ply") && bytes.size() > 3 &&
         (bytes[3] == '\n' || bytes[3] == '\r' || bytes[3] == ' ' || bytes[3] == '\t');
}

Result<PlyHeader> parse_ply_header(std::string_view bytes, const std::string& where) {
  if (bytes.empty()) {
    return bad_input(where, "the file is empty", "copy or export it again");
  }
  if (!is_ply(bytes)) {
    return bad_input(where, "not a PLY file (it does not begin with 'ply')", "check what the file is");
  }
  const std::string_view head = bytes.substr(0, kMaxPlyHeaderBytes);
  TextScanner scanner(head);
  // Lines of an old Macintosh end with a carriage return alone.
  const std::string_view unmarked = without_byte_order_mark(head);
  const char line_end = unmarked.starts_with("ply\r") && !unmarked.starts_with("ply\r\n") ? '\r' : '\n';
  (void)scanner.line(line_end);
  PlyHeader header;
  bool has_format = false;
  for (std::size_t line_number = 2; scanner.remaining() > 0; ++line_number) {
    std::string_view rest = scanner.line(line_end);
    const std::string_view keyword = take_word(rest);
    Complaint complaint;
    if (keyword == "end_header") {
      if (!has_format) {
        return bad_input(where, "the PLY header names no format", kExportAgain);
      }
      header.body_offset = scanner.position();
      return header;
    }
    if (keyword == "format") {
      complaint = read_format(rest, header);
      has_format = true;
    } else if (keyword == "element") {
      complaint = read_element(rest, header);
    } else if (keyword == "property") {
      complaint = read_property(rest, header);
    } else if (keyword == "obj_info") {
      const std::string_view key = take_word(rest);
      const std::size_t first = rest.find_first_not_of(" \t");
      header.info.emplace_back(key,
                               first == std::string_view::npos ? std::string_view() : rest.substr(first));
    }
    if (complaint) {
      return bad_input(where, "header line " + std::to_string(line_number) + ": " + *complaint, kExportAgain);
    }
  }
  return bad_input(where,
                   head.size() < bytes.size()
                       ? "no end_header in the first " + std::to_string(kMaxPlyHeaderBytes) + " bytes"
                       : "the file ends within its PLY header (no end_header)",
                   "the file is cut short or not a PLY file: copy or export it again");
}

bool states_unit(std::string_view bytes, const std::string& where) {
  const Result<PlyHeader> header = is_ply(bytes) ? parse_ply_header(bytes, where) : Result<PlyHeader>();
  return header && header->info_value(ply_info::kUnit).has_value();
}

}  // namespace dubsar
