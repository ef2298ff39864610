// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/grid_file.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "core/parallel.h"
#include "formats/atomic_file.h"
#include "formats/byte_order.h"
#include "formats/grid_chunks.h"
#include "formats/grid_header.h"

namespace dubsar {

namespace {

constexpr const char* kRestore = "restore the file from a copy";

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::uint64_t checksum(std::string_view bytes) {
  return XXH64(bytes.data(), bytes.size(), 0);
}

/// One bit a cell, the first cell in the lowest bit.
std::string pack_mask(const std::vector<std::uint8_t>& valid) {
  std::string bits(valid.size() / 8 + (valid.size() % 8 != 0 ? 1 : 0), '\0');
  for (std::size_t i = 0; i < valid.size(); ++i) {
    if (valid[i] != 0) {
      bits[i / 8] = static_cast<char>(static_cast<unsigned char>(bits[i / 8]) | 1U << (i % 8));
    }
  }
  return bits;
}

/// The values of the valid cells, `channels` a cell.
template <class T>
std::vector<T> compact(const std::vector<T>& values, const std::vector<std::uint8_t>& valid,
                       std::size_t count, std::size_t channels) {
  std::vector<T> kept;
  kept.reserve(count * channels);
  for (std::size_t i = 0; i < valid.size(); ++i) {
    if (valid[i] != 0) {
      kept.insert(kept.end(), values.begin() + static_cast<std::ptrdiff_t>(i * channels),
                  values.begin() + static_cast<std::ptrdiff_t>((i + 1) * channels));
    }
  }
  return kept;
}

template <class T>
void spread(const std::vector<T>& kept, const std::vector<std::uint8_t>& valid, std::size_t channels,
            std::vector<T>& values) {
  values.assign(valid.size() * channels, T{});
  std::size_t from = 0;
  for (std::size_t i = 0; i < valid.size(); ++i) {
    for (std::size_t k = 0; valid[i] != 0 && k < channels; ++k) {
      values[i * channels + k] = kept[from++];
    }
  }
}

/// The float arrays that a grid file holds, in file order.
template <class Grid>
auto float_arrays(Grid& grid, std::uint32_t parts) {
  std::vector<decltype(&grid.x)> arrays{&grid.x, &grid.y, &grid.z};
  if ((parts & kGridHasIntensity) != 0) {
    arrays.push_back(&grid.intensity);
  }
  if ((parts & kGridHasConfidence) != 0) {
    arrays.push_back(&grid.confidence);
  }
  return arrays;
}

std::uint32_t parts_of(const RangeGrid& grid) {
  std::uint32_t parts = 0;
  parts |= grid.view.laser_mm ? kGridHasLaser : 0U;
  parts |= grid.view.camera_mm ? kGridHasCamera : 0U;
  parts |= grid.nominal ? kGridHasNominal : 0U;
  parts |= grid.intensity.empty() ? 0U : kGridHasIntensity;
  parts |= grid.confidence.empty() ? 0U : kGridHasConfidence;
  parts |= grid.rgb.empty() ? 0U : kGridHasColour;
  return parts;
}

/// A return without a place would upset every later stage.
void drop_not_finite(RangeGrid& grid) {
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (!std::isfinite(grid.x[i]) || !std::isfinite(grid.y[i]) || !std::isfinite(grid.z[i])) {
      grid.valid[i] = 0;
      grid.x[i] = grid.y[i] = grid.z[i] = 0.0F;
    }
  }
}

/// False when the mask has bits behind its end or another count than the header says.
bool read_mask(std::string_view bits, GridHeader& header) {
  RangeGrid& grid = header.grid;
  grid.allocate(grid.rows, grid.cols);
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.valid[i] = static_cast<std::uint8_t>(static_cast<unsigned char>(bits[i / 8]) >> (i % 8) & 1U);
    count += grid.valid[i];
  }
  return count == header.valid_count;
}

}  // namespace

bool is_grid_file(std::string_view head) {
  return head.starts_with(kGridMagic);
}

std::vector<std::byte> encode_grid(const RangeGrid& grid) {
  GridHeader header;
  // The header's grid carries no samples; copying them only to drop them would double the memory.
  header.grid.rows = grid.rows;
  header.grid.cols = grid.cols;
  header.grid.spacing_mm = grid.spacing_mm;
  header.grid.view = grid.view;
  header.grid.nominal = grid.nominal;
  header.grid.pin_tip_diameter_mm = grid.pin_tip_diameter_mm;
  header.grid.timestamp_ns = grid.timestamp_ns;
  header.grid.device = grid.device;
  header.grid.source = grid.source;
  header.parts = parts_of(grid);
  header.valid_count = static_cast<std::uint64_t>(
      std::count_if(grid.valid.begin(), grid.valid.end(), [](std::uint8_t v) { return v != 0; }));

  const auto arrays = float_arrays(grid, header.parts);
  const bool has_colour = (header.parts & kGridHasColour) != 0;
  std::vector<std::string> chunks(1 + arrays.size() + (has_colour ? 1 : 0));
  const std::size_t kept = header.valid_count;
  parallel_for_each_index(
      chunks.size(),
      [&](std::size_t chunk) {
        if (chunk == 0) {
          chunks[chunk] = pack_mask(grid.valid);
        } else if (chunk <= arrays.size()) {
          chunks[chunk] = pack_floats(compact(*arrays[chunk - 1], grid.valid, kept, 1));
        } else {
          chunks[chunk] = pack_bytes(compact(grid.rgb, grid.valid, kept, 3));
        }
      },
      1);

  std::uint64_t payload = 0;
  for (const std::string& chunk : chunks) {
    header.chunk_bytes.push_back(chunk.size());
    payload += chunk.size();
  }
  header.file_bytes = encode_grid_header(header).size() + payload + kGridChecksumBytes;
  std::string file = encode_grid_header(header);
  file.reserve(header.file_bytes);
  for (const std::string& chunk : chunks) {
    file += chunk;
  }
  append(file, checksum(file));
  const auto bytes = std::as_bytes(std::span(file));
  return {bytes.begin(), bytes.end()};
}

Status verify_grid_bytes(std::span<const std::byte> bytes, const std::string& where) {
  const std::string_view file = text_of(bytes);
  if (Status prelude = check_grid_prelude(file, where); !prelude) {
    return prelude;
  }
  const std::string_view covered = file.substr(0, file.size() - kGridChecksumBytes);
  if (load<std::uint64_t>(file.data() + covered.size()) != checksum(covered)) {
    return bad_input(where, "its bytes do not match their checksum", kRestore);
  }
  return {};
}

Result<RangeGrid> decode_grid(std::span<const std::byte> bytes, const std::string& where) {
  if (Status whole = verify_grid_bytes(bytes, where); !whole) {
    return std::unexpected(whole.error());
  }
  const std::string_view file = text_of(bytes);
  Result<GridHeader> header = decode_grid_header(file, where);
  if (!header) {
    return std::unexpected(header.error());
  }
  std::vector<std::string_view> chunks;
  std::size_t at = header->header_bytes;
  for (const std::uint64_t size : header->chunk_bytes) {
    chunks.push_back(file.substr(at, size));
    at += size;
  }
  if (!read_mask(chunks[0], *header)) {
    return bad_input(where, "its mask does not have as many samples as its header says", kRestore);
  }
  RangeGrid& grid = header->grid;
  const auto arrays = float_arrays(grid, header->parts);
  const std::size_t kept = header->valid_count;
  std::vector<std::uint8_t> good(chunks.size(), 0);
  parallel_for_each_index(
      chunks.size() - 1,
      [&](std::size_t i) {
        const std::size_t chunk = i + 1;
        if (chunk <= arrays.size()) {
          std::vector<float> values(kept);
          good[chunk] = unpack_floats(chunks[chunk], values) ? 1 : 0;
          spread(values, grid.valid, 1, *arrays[chunk - 1]);
        } else {
          std::vector<std::uint8_t> values(3 * kept);
          good[chunk] = unpack_bytes(chunks[chunk], values) ? 1 : 0;
          spread(values, grid.valid, 3, grid.rgb);
        }
      },
      1);
  for (std::size_t chunk = 1; chunk < chunks.size(); ++chunk) {
    if (good[chunk] == 0) {
      return bad_input(where, "chunk " + std::to_string(chunk) + " does not unpack to its samples", kRestore);
    }
  }
  drop_not_finite(grid);
  return std::move(grid);
}

Result<RangeGrid> read_grid_file(const std::filesystem::path& path) {
  const Result<std::string> bytes = read_whole_file(path);
  if (!bytes) {
    return std::unexpected(bytes.error());
  }
  return decode_grid(std::as_bytes(std::span(*bytes)), path.string());
}

Status write_grid_file(const std::filesystem::path& path, const RangeGrid& grid) {
  return write_file_atomically(path, std::span<const std::byte>(encode_grid(grid)));
}

Status verify_grid_file(const std::filesystem::path& path) {
  const Result<std::string> bytes = read_whole_file(path);
  if (!bytes) {
    return std::unexpected(bytes.error());
  }
  return verify_grid_bytes(std::as_bytes(std::span(*bytes)), path.string());
}

}  // namespace dubsar
