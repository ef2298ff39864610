// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <charconv>
#include <optional>
#include <vector>

#include "formats/mesh_formats.h"
#include "formats/number_text.h"
#include "formats/text_scanner.h"

namespace dubsar {

namespace {

constexpr const char* kExportAgain = "export the mesh again";

std::unexpected<Error> line_error(const std::string& where, std::size_t line, const std::string& what) {
  return bad_input(where, "line " + std::to_string(line) + ": " + what, kExportAgain);
}

/// The vertex of a corner such as "7", "7/1", "7//2" or "-1" (counted back from the last); nothing when it is
/// none.
std::optional<std::uint32_t> corner_of(std::string_view word, std::size_t vertices) {
  const std::string_view index_word = word.substr(0, word.find('/'));
  std::int64_t index = 0;
  if (!parse_integer(index_word, index)) {
    return std::nullopt;
  }
  const auto count = static_cast<std::int64_t>(vertices);
  const std::int64_t at = index < 0 ? count + index : index - 1;
  if (index == 0 || at < 0 || at >= count) {
    return std::nullopt;
  }
  return static_cast<std::uint32_t>(at);
}

}  // namespace

Result<Mesh> decode_mesh_obj(std::string_view bytes, const std::string& where,
                             const MeshReadOptions& options) {
  const double mm = options.mm_per_unit.value_or(1.0);
  Mesh mesh;
  std::vector<std::uint32_t> corners;
  TextScanner text(bytes);
  bool any_keyword = false;
  for (std::size_t line_number = 1; text.remaining() > 0; ++line_number) {
    std::string_view rest = text.line();
    const std::string_view keyword = take_word(rest);
    if (keyword == "v") {
      double xyz[3];
      for (double& coordinate : xyz) {
        const std::string_view word = take_word(rest);
        if (!parse_number(word, coordinate)) {
          return line_error(where, line_number, in_quotes(word) + " is not a coordinate");
        }
      }
      if (!append_position(mesh, mm * xyz[0], mm * xyz[1], mm * xyz[2])) {
        return line_error(where, line_number, "a position is not finite");
      }
      any_keyword = true;
    } else if (keyword == "f") {
      corners.clear();
      for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
        const std::optional<std::uint32_t> corner = corner_of(word, mesh.positions.size());
        if (!corner) {
          return line_error(where, line_number,
                            in_quotes(word) + " is not one of the " + std::to_string(mesh.positions.size()) +
                                " vertices so far");
        }
        corners.push_back(*corner);
      }
      append_polygon(mesh, corners);
      any_keyword = true;
    }
  }
  if (!any_keyword) {
    return bad_input(where, "not an OBJ mesh (no line begins with v or f)", "check what the file is");
  }
  return mesh;
}

std::string encode_mesh_obj(const Mesh& mesh, const FileLabel& label) {
  std::string out = "# Mesh of Dubsar, millimetres\n" + label_lines(label, "# ");
  const auto append_three = [&](const char* keyword, const Eigen::Vector3f& v) {
    out += keyword;
    for (const float component : v) {
      out += ' ';
      append_number(out, component);
    }
    out += '\n';
  };
  for (const Eigen::Vector3f& position : mesh.positions) {
    append_three("v", position);
  }
  for (const Eigen::Vector3f& normal : mesh.normals) {
    append_three("vn", normal);
  }
  for (const auto& face : mesh.faces) {
    out += 'f';
    for (const std::uint32_t corner : face) {
      const std::string number = std::to_string(std::uint64_t{corner} + 1);
      out += ' ';
      out += number;
      if (!mesh.normals.empty()) {
        out += "//";
        out += number;
      }
    }
    out += '\n';
  }
  return out;
}

}  // namespace dubsar
