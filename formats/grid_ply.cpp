// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/grid_ply.h"

#include <cstdint>

#include "core/number_text.h"
#include "formats/atomic_file.h"
#include "formats/byte_order.h"
#include "formats/ply_scan_info.h"

namespace dubsar {

namespace {

std::string header_of(const RangeGrid& grid, const GridPlyOptions& options) {
  std::string text = options.ascii ? "ply\nformat ascii 1.0\n" : "ply\nformat binary_little_endian 1.0\n";
  text += "comment Range grid of Dubsar; rows are profiles\n" + label_lines(options.label, "comment ") +
          scan_info_lines(grid, options.keep_source);
  text += "element vertex " + std::to_string(grid.valid_count()) +
          "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!grid.intensity.empty()) {
    text += "property float intensity\n";
  }
  if (!grid.confidence.empty()) {
    text += "property float confidence\n";
  }
  if (!grid.rgb.empty()) {
    text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  }
  text += "element range_grid " + std::to_string(grid.size()) +
          "\nproperty list uchar int vertex_indices\nend_header\n";
  return text;
}

/// Calls put(float) and put(uint8) for the properties of one vertex, in header order.
template <class Put>
void put_vertex(const RangeGrid& grid, std::size_t i, const Put& put) {
  put(grid.x[i]);
  put(grid.y[i]);
  put(grid.z[i]);
  if (!grid.intensity.empty()) {
    put(grid.intensity[i]);
  }
  if (!grid.confidence.empty()) {
    put(grid.confidence[i]);
  }
  for (std::size_t k = 0; k < 3 && !grid.rgb.empty(); ++k) {
    put(grid.rgb[3 * i + k]);
  }
}

struct AsciiPut {
  std::string& text;
  void operator()(float value) const {
    append_number(text, value);
    text += ' ';
  }
  void operator()(std::uint8_t value) const {
    text += std::to_string(value);
    text += ' ';
  }
};

struct BinaryPut {
  std::string& bytes;
  template <class T>
  void operator()(T value) const {
    append(bytes, value);
  }
};

}  // namespace

std::string encode_grid_ply(const RangeGrid& grid, const GridPlyOptions& options) {
  std::string out = header_of(grid, options);
  out.reserve(out.size() + grid.valid_count() * 32 + grid.size() * 2);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] == 0) {
      continue;
    }
    if (options.ascii) {
      put_vertex(grid, i, AsciiPut{out});
      out += '\n';
    } else {
      put_vertex(grid, i, BinaryPut{out});
    }
  }
  std::int32_t next = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const bool valid = grid.valid[i] != 0;
    if (options.ascii) {
      out += valid ? "1 " + std::to_string(next) + "\n" : "0\n";
    } else {
      out += static_cast<char>(valid ? 1 : 0);
      if (valid) {
        append(out, next);
      }
    }
    next += valid ? 1 : 0;
  }
  return out;
}

Status write_grid_ply(const std::filesystem::path& path, const RangeGrid& grid,
                      const GridPlyOptions& options) {
  return write_file_atomically(path, encode_grid_ply(grid, options));
}

}  // namespace dubsar
