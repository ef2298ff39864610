// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/number_text.h"
#include "formats/colour_values.h"
#include "formats/mesh_formats.h"
#include "formats/text_scanner.h"

namespace dubsar {

namespace {

constexpr const char* kExportAgain = "export the mesh again";

/// Reads an OBJ mesh line by line.
class ObjReader {
 public:
  ObjReader(std::string_view bytes, const std::string& where, const MeshReadOptions& options)
      : text_(bytes), where_(where), options_(options), mm_(options.mm_per_unit.value_or(1.0)) {}

  [[nodiscard]] Result<Mesh> mesh() {
    bool any_keyword = false;
    constexpr std::size_t kAskEvery = 4096;  // lines
    while (text_.remaining() > 0) {
      if (line_number_ % kAskEvery == 0 && is_stopped(options_.job)) {
        return reading_stopped(where_);
      }
      std::string_view rest = next_line();
      const std::string_view keyword = take_word(rest);
      const bool is_vertex = keyword == "v";
      textured_ = textured_ || keyword == "vt";
      if (is_vertex || keyword == "f") {
        any_keyword = true;
        rest = with_what_follows(rest);
        if (const Status read = is_vertex ? read_vertex(rest) : read_face(rest); !read) {
          return std::unexpected(read.error());
        }
      }
    }
    if (!any_keyword) {
      return bad_input(where_, "not an OBJ mesh (no line begins with v or f)", "check what the file is");
    }
    if (highest_ > static_cast<std::int64_t>(mesh_.positions.size())) {
      return line_error(highest_line_, in_quotes(std::to_string(highest_)) + " is not one of the " +
                                           std::to_string(mesh_.positions.size()) + " vertices");
    }
    if (mesh_.faces.empty() && !options_.may_be_points) {
      return bad_input(where_, "an OBJ file without faces",
                       "give a mesh; scans become one with dubsar stitch");
    }
    lay_colours();
    if (textured_ && options_.passed_over != nullptr) {
      *options_.passed_over = {kTextureCoordinates};
    }
    return std::move(mesh_);
  }

 private:
  std::string_view next_line() {
    ++line_number_;
    return text_.line();
  }
  /// A line that ends with a backslash goes on in the next.
  std::string_view with_what_follows(std::string_view line) {
    if (!line.ends_with('\\')) {
      return line;
    }
    joined_.clear();
    for (; line.ends_with('\\') && text_.remaining() > 0; line = next_line()) {
      line.remove_suffix(1);
      joined_ += line;
      joined_ += ' ';
    }
    return joined_ += line;
  }
  [[nodiscard]] std::unexpected<Error> line_error(std::size_t line, const std::string& what) const {
    return bad_input(where_, "line " + std::to_string(line) + ": " + what, kExportAgain);
  }
  Status read_vertex(std::string_view rest) {
    double xyz[3];
    for (double& coordinate : xyz) {
      const std::string_view word = take_word(rest);
      if (!parse_number(word, coordinate)) {
        return line_error(line_number_, in_quotes(word) + " is not a coordinate");
      }
    }
    if (!append_position(mesh_, mm_ * xyz[0], mm_ * xyz[1], mm_ * xyz[2])) {
      return line_error(line_number_, "a position is not finite");
    }
    read_colour(rest);
    return {};
  }
  /// Red, green and blue behind the place, as many programs write them; one number alone is a weight.
  void read_colour(std::string_view rest) {
    std::array<double, 3> rgb{};
    for (double& component : rgb) {
      if (!parse_number(take_word(rest), component)) {
        return;
      }
    }
    constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();
    constexpr std::array<float, 3> kNoColour{kNotANumber, kNotANumber, kNotANumber};
    colours_.resize(mesh_.positions.size() - 1, kNoColour);
    colours_.push_back({static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2])});
  }
  /// From 0 to 1, or to 255 where any runs so far; white where a line has none.
  void lay_colours() {
    if (colours_.empty()) {
      return;
    }
    const bool bytes =
        std::ranges::any_of(colours_, [](const auto& rgb) { return std::ranges::any_of(rgb, runs_to_255); });
    mesh_.colours.resize(mesh_.positions.size(), {255, 255, 255});
    for (std::size_t v = 0; v < colours_.size(); ++v) {
      for (std::size_t k = 0; k < 3 && !std::isnan(colours_[v][0]); ++k) {
        mesh_.colours[v][k] = colour_byte(static_cast<double>(colours_[v][k]) / (bytes ? 255.0 : 1.0));
      }
    }
  }
  /// Corners such as "7", "7/1", "7//2" or "-1" (counted back from the last); vertices may follow later.
  Status read_face(std::string_view rest) {
    corners_.clear();
    for (std::string_view word = take_word(rest); !word.empty() && word.front() != '#';
         word = take_word(rest)) {
      const std::optional<std::uint32_t> corner = corner_of(word);
      if (!corner) {
        return line_error(line_number_, in_quotes(word) + " is not one of the " +
                                            std::to_string(mesh_.positions.size()) + " vertices so far");
      }
      corners_.push_back(*corner);
    }
    append_polygon(mesh_, corners_);
    return {};
  }
  std::optional<std::uint32_t> corner_of(std::string_view word) {
    std::int64_t index = 0;
    if (!parse_integer(word.substr(0, word.find('/')), index) || index == 0 || index > kMostVertices) {
      return std::nullopt;
    }
    if (index > highest_) {
      highest_ = index;
      highest_line_ = line_number_;
    }
    const std::int64_t at = index < 0 ? static_cast<std::int64_t>(mesh_.positions.size()) + index : index - 1;
    return at < 0 ? std::nullopt : std::optional(static_cast<std::uint32_t>(at));
  }

  static constexpr std::int64_t kMostVertices = 0xfffffffe;
  TextScanner text_;
  const std::string& where_;
  const MeshReadOptions& options_;
  double mm_;
  Mesh mesh_;
  std::vector<std::array<float, 3>> colours_;  ///< of the first vertices; empty while none has one
  std::vector<std::uint32_t> corners_;
  std::string joined_;  ///< a line of several
  std::size_t line_number_ = 0;
  std::int64_t highest_ = 0;  ///< of the corners counted from the first vertex
  std::size_t highest_line_ = 0;
  bool textured_ = false;
};

/// " red green blue" behind a place, from 0 to 1 with six decimals, rounded up: whoever multiplies by 255
/// gets the byte, rounding or cutting off.
void append_colour(std::string& out, const std::array<std::uint8_t, 3>& rgb) {
  constexpr std::uint32_t kDecimals = 1000000;
  for (const std::uint8_t byte : rgb) {
    out += ' ';
    out += number_text(((byte * kDecimals + 254) / 255) / static_cast<double>(kDecimals));
  }
}

}  // namespace

Result<Mesh> decode_mesh_obj(std::string_view bytes, const std::string& where,
                             const MeshReadOptions& options) {
  bytes = without_byte_order_mark(bytes);
  std::string in_lines;
  if (bytes.find('\n') == std::string_view::npos) {  // lines of an old Macintosh
    in_lines = bytes;
    std::ranges::replace(in_lines, '\r', '\n');
    bytes = in_lines;
  }
  return ObjReader(bytes, where, options).mesh();
}

Status produce_mesh_obj(const Mesh& mesh, const ByteSink& sink, const FileLabel& label) {
  constexpr std::size_t kPiece = std::size_t{1} << 20U;
  std::string out = mesh_line(label, "# ");
  out.insert(out.size() - 1, ", millimetres");
  out += label_lines(label, "# ");
  const auto append_three = [&](const char* keyword, const Eigen::Vector3f& v) {
    out += keyword;
    for (const float component : v) {
      out += ' ';
      append_number(out, component);
    }
  };
  const auto end_line = [&]() -> Status {
    out += '\n';
    if (out.size() < kPiece) {
      return {};
    }
    const Status taken = sink(std::as_bytes(std::span(out)));
    out.clear();
    return taken;
  };
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    append_three("v", mesh.positions[v]);
    if (!mesh.colours.empty()) {
      append_colour(out, mesh.colours[v]);
    }
    if (const Status passed = end_line(); !passed) {
      return passed;
    }
  }
  for (const Eigen::Vector3f& normal : mesh.normals) {
    append_three("vn", normal);
    if (const Status passed = end_line(); !passed) {
      return passed;
    }
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
    if (const Status passed = end_line(); !passed) {
      return passed;
    }
  }
  return out.empty() ? Status() : sink(std::as_bytes(std::span(out)));
}

std::string encode_mesh_obj(const Mesh& mesh, const FileLabel& label) {
  return whole_text([&](const ByteSink& sink) { return produce_mesh_obj(mesh, sink, label); });
}

}  // namespace dubsar
