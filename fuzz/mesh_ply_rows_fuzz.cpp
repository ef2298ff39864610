// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Binary rows of one size, which are read many at a time, against the same rows one by one: an empty list at
// the end of every vertex and a byte after every face make that of them. Both must say the same.
#include <string>

#include "formats/mesh_io.h"
#include "fuzz/fuzz_support.h"

namespace {

constexpr std::size_t kMostVertices = 64;

struct Input {
  const std::uint8_t* data;
  std::size_t size;
  std::uint8_t next() {
    if (size == 0) {
      return 0;
    }
    --size;
    return *data++;
  }
};

struct Shape {
  bool big_endian, normals, reliability, doubles;
  std::size_t vertices;
};

void put(std::string& out, std::uint32_t value, bool big_endian) {
  for (int k = 0; k < 4; ++k) {
    out += static_cast<char>(value >> (8U * static_cast<unsigned>(big_endian ? 3 - k : k)));
  }
}

std::string file_of(const Shape& shape, Input in, bool one_by_one) {
  std::string rows;
  const std::size_t floats =
      (shape.doubles ? 6U : 3U) + (shape.normals ? 3U : 0U) + (shape.reliability ? 1U : 0U);
  for (std::size_t v = 0; v < shape.vertices; ++v) {
    for (std::size_t k = 0; k < 4 * floats; ++k) {
      rows += static_cast<char>(in.next());
    }
    rows += one_by_one ? std::string(1, '\0') : std::string();
  }
  std::size_t faces = 0;
  for (; in.size > 0; ++faces) {
    const std::uint8_t kind = in.next();
    const bool odd = kind > 250;  // no triangle: then all are read one by one
    const unsigned corners = odd ? kind - 250U : 3U;
    rows += static_cast<char>(corners);
    for (unsigned k = 0; k < corners; ++k) {
      const std::uint32_t low = in.next();
      put(rows,
          kind == 1 ? (low << 24U) : low % static_cast<std::uint32_t>(shape.vertices + (kind == 2 ? 1 : 0)),
          shape.big_endian);
    }
    rows += one_by_one ? std::string(1, '\0') : std::string();
  }
  std::string out = "ply\nformat binary_";
  out += shape.big_endian ? "big" : "little";
  out += "_endian 1.0\nelement vertex " + std::to_string(shape.vertices) + "\n";
  for (const char* axis : {"x", "y", "z"}) {
    out += std::string("property ") + (shape.doubles ? "double " : "float ") + axis + "\n";
  }
  if (shape.normals) {
    out += "property float nx\nproperty float ny\nproperty float nz\n";
  }
  if (shape.reliability) {
    out += "property float reliability\n";
  }
  out += one_by_one ? "property list uchar uchar nothing\n" : "";
  out += "element face " + std::to_string(faces) + "\nproperty list uchar int vertex_indices\n";
  out += one_by_one ? "property uchar nothing\n" : "";
  return out + "end_header\n" + rows;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input in{data, size};
  const std::uint8_t bits = in.next();
  const Shape shape{(bits & 1U) != 0, (bits & 2U) != 0, (bits & 4U) != 0, (bits & 8U) != 0,
                    1 + in.next() % kMostVertices};
  const auto at_once = dubsar::read_mesh_bytes(file_of(shape, in, false), "mesh.ply");
  const auto one_by_one = dubsar::read_mesh_bytes(file_of(shape, in, true), "mesh.ply");
  dubsar::fuzz::require(at_once.has_value() == one_by_one.has_value());
  if (!at_once) {
    dubsar::fuzz::require(at_once.error().what == one_by_one.error().what);
    return 0;
  }
  dubsar::fuzz::check_mesh(*at_once);
  dubsar::fuzz::require(
      at_once->positions == one_by_one->positions && at_once->normals == one_by_one->normals &&
      at_once->reliability == one_by_one->reliability && at_once->faces == one_by_one->faces);
  return 0;
}
