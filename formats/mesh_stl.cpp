// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/log.h"
#include "formats/byte_order.h"
#include "formats/bytes_left_over.h"
#include "formats/filed_mesh.h"
#include "formats/mesh_formats.h"
#include "formats/text_scanner.h"

namespace dubsar {

namespace {

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kFacetBytes = 50;
constexpr const char* kExportAgain = "the file is cut short or no STL: copy or export it again";

/// A word in any case.
bool is(std::string_view word, std::string_view keyword) {
  return std::ranges::equal(word, keyword, [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a + ('a' - 'A')) : a) == b;
  });
}

/// Words in any case and in lines of any kind, as ASCII STL is written.
class AsciiReader {
 public:
  AsciiReader(std::string_view bytes, const std::string& where, double mm, const JobContext* job)
      : bytes_(bytes), rest_(bytes), where_(where), mm_(mm), job_(job) {}

  [[nodiscard]] Result<Mesh> mesh() {
    bool within = false;                     // a solid
    constexpr std::size_t kAskEvery = 4096;  // words
    std::size_t words = 0;
    for (std::string_view word = take_word(rest_); !word.empty(); word = take_word(rest_)) {
      if (words++ % kAskEvery == 0 && is_stopped(job_)) {
        return reading_stopped(where_);
      }
      Status status;
      if (is(word, "vertex")) {
        status = read_vertex();
      } else if (is(word, "endloop") || is(word, "facet") || is(word, "endsolid")) {
        status = close_loop();
      }
      if (!status) {
        return std::unexpected(status.error());
      }
      if (is(word, "solid") || is(word, "endsolid")) {
        within = is(word, "solid");
        pass_name();
      }
    }
    if (const Status closed = close_loop(); !closed) {
      return std::unexpected(closed.error());
    }
    if (within || mesh_.faces.empty()) {
      return bad_input(where_,
                       mesh_.faces.empty() ? "holds no facet" : "ends before its solid does (no endsolid)",
                       kExportAgain);
    }
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] std::unexpected<Error> error(const std::string& what) const {
    const auto line =
        1 + std::count(bytes_.begin(), bytes_.end() - static_cast<std::ptrdiff_t>(rest_.size()), '\n');
    return bad_input(where_, "line " + std::to_string(line) + ": " + what, kExportAgain);
  }
  /// To the end of the line, or to the first facet where there are no lines.
  void pass_name() {
    while (!rest_.empty() && rest_.front() != '\n' && rest_.front() != '\r') {
      std::size_t step = 1;  // over a blank
      if (rest_.front() != ' ' && rest_.front() != '\t') {
        std::string_view after = rest_;
        const std::string_view word = take_word(after);
        if (is(word, "facet")) {
          return;
        }
        step = std::max<std::size_t>(word.size(), 1);
      }
      rest_.remove_prefix(step);
    }
  }
  Status read_vertex() {
    std::array<double, 3> v{};
    for (double& coordinate : v) {
      const std::string_view word = take_word(rest_);
      if (!parse_number(word, coordinate)) {
        return error(in_quotes(word) + " is not a coordinate");
      }
    }
    loop_.push_back(static_cast<std::uint32_t>(mesh_.positions.size()));
    return append_position(mesh_, mm_ * v[0], mm_ * v[1], mm_ * v[2]) ? Status()
                                                                      : error("a position is not finite");
  }
  Status close_loop() {
    if (loop_.size() == 1 || loop_.size() == 2) {
      return bad_input(where_, "ends within a facet", kExportAgain);
    }
    append_polygon(mesh_, loop_);
    loop_.clear();
    return {};
  }

  std::string_view bytes_, rest_;
  const std::string& where_;
  double mm_;
  const JobContext* job_;
  Mesh mesh_;
  std::vector<std::uint32_t> loop_;
};

/// Text begins with "solid", as do some binary files; those hold zero bytes.
bool is_ascii_stl(std::string_view bytes) {
  constexpr std::size_t kLooked = 512;
  std::string_view start = bytes.substr(0, kLooked);
  if (start.find('\0') != std::string_view::npos || is_binary_stl(bytes)) {
    return false;
  }
  const std::string_view word = take_word(start);
  return is(word, "solid") || is(word, "facet");
}

Result<Mesh> decode_binary(std::string_view bytes, const std::string& where, double mm) {
  if (bytes.size() < kHeaderBytes + 4) {
    return bad_input(where, "ends within its STL header", kExportAgain);
  }
  const auto count = load<std::uint32_t>(bytes.data() + kHeaderBytes);
  const std::size_t room = (bytes.size() - kHeaderBytes - 4) / kFacetBytes;
  if (count == 0) {
    return bad_input(where, "holds no facet", kExportAgain);
  }
  if (count > room) {
    return bad_input(where, "claims " + std::to_string(count) + " facets, but holds " + std::to_string(room),
                     kExportAgain);
  }
  Mesh mesh;
  mesh.positions.reserve(std::size_t{3} * count);
  mesh.faces.reserve(count);
  for (std::uint32_t facet = 0; facet < count; ++facet) {
    const char* at = bytes.data() + kHeaderBytes + 4 + facet * kFacetBytes + 12;
    for (int corner = 0; corner < 3; ++corner, at += 12) {
      if (!append_position(mesh, mm * static_cast<double>(load<float>(at)),
                           mm * static_cast<double>(load<float>(at + 4)),
                           mm * static_cast<double>(load<float>(at + 8)))) {
        return bad_input(where, "facet " + std::to_string(facet) + ": a position is not finite",
                         kExportAgain);
      }
    }
    const auto last = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.faces.push_back({last - 3, last - 2, last - 1});
  }
  const std::string_view rest = bytes.substr(kHeaderBytes + 4 + std::size_t{count} * kFacetBytes);
  if (const std::string left_over = bytes_left_over(rest); !left_over.empty()) {
    log_warning(Error{ErrorKind::kBadInput, left_over, where, {}}.line());
  }
  return mesh;
}

}  // namespace

bool is_binary_stl(std::string_view bytes) {
  if (bytes.size() < kHeaderBytes + 4) {
    return false;
  }
  const std::uint64_t count = load<std::uint32_t>(bytes.data() + kHeaderBytes);
  return bytes.size() == kHeaderBytes + 4 + count * kFacetBytes;
}

Result<Mesh> decode_mesh_stl(std::string_view bytes, const std::string& where,
                             const MeshReadOptions& options) {
  return mesh_of(decode_filed_stl(bytes, where, options));
}

Result<FiledMesh> decode_filed_stl(std::string_view bytes, const std::string& where,
                                   const MeshReadOptions& options) {
  const double mm = options.mm_per_unit.value_or(1.0);
  const std::string_view text = without_byte_order_mark(bytes);
  Result<Mesh> mesh =
      is_ascii_stl(text) ? AsciiReader(text, where, mm, options.job).mesh() : decode_binary(bytes, where, mm);
  if (!mesh) {
    return std::unexpected(mesh.error());
  }
  const std::size_t corners = mesh->positions.size();
  weld_equal_positions(*mesh);
  return FiledMesh{*std::move(mesh), corners};
}

std::string encode_mesh_stl(const Mesh& mesh, const FileLabel& label) {
  // Never "solid", which would be taken for the text form.
  std::string out = !label.empty()         ? "Dubsar, mm; "
                    : label.origin.empty() ? "Mesh of Dubsar, millimetres"
                                           : "Written by Dubsar, millimetres";
  out += label_in_ascii(label, kHeaderBytes - out.size());
  out.resize(kHeaderBytes, ' ');
  out.reserve(kHeaderBytes + 4 + mesh.faces.size() * kFacetBytes);
  append(out, static_cast<std::uint32_t>(mesh.faces.size()));
  for (const auto& face : mesh.faces) {
    const Eigen::Vector3f& a = mesh.positions[face[0]];
    const Eigen::Vector3f& b = mesh.positions[face[1]];
    const Eigen::Vector3f& c = mesh.positions[face[2]];
    Eigen::Vector3f normal = (b - a).cross(c - a);
    normal = normal.norm() > 0 ? Eigen::Vector3f(normal.normalized()) : Eigen::Vector3f::Zero();
    for (const Eigen::Vector3f& three : {normal, a, b, c}) {
      append(out, three.x());
      append(out, three.y());
      append(out, three.z());
    }
    append(out, std::uint16_t{0});
  }
  return out;
}

}  // namespace dubsar
