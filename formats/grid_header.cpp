// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/grid_header.h"

#include <cmath>
#include <initializer_list>

#include "formats/byte_order.h"
#include "formats/grid_file.h"

namespace dubsar {

namespace {

constexpr const char* kRestore = "restore the file from a copy";
constexpr std::size_t kMaxTextBytes = std::size_t{1} << 16U;

void append_vector(std::string& to, const Eigen::Vector3d& v) {
  for (const double component : v) {
    append(to, component);
  }
}

void append_text(std::string& to, std::string_view text) {
  text = text.substr(0, kMaxTextBytes);
  append(to, static_cast<std::uint32_t>(text.size()));
  to += text;
}

/// Reads the header field by field; one that does not fit sets `ok` false and gives zero.
struct FieldReader {
  std::string_view bytes;
  std::size_t at = 0;
  bool ok = true;

  template <class T>
  T next() {
    if (bytes.size() - at < sizeof(T)) {
      ok = false;
      at = bytes.size();
      return T{};
    }
    const T value = load<T>(bytes.data() + at);
    at += sizeof(T);
    return value;
  }
  double finite() {
    const auto value = next<double>();
    ok = ok && std::isfinite(value);
    return value;
  }
  Eigen::Vector3d vector() {
    Eigen::Vector3d v;
    for (double& component : v) {
      component = finite();
    }
    return v;
  }
  std::string text() {
    const auto length = next<std::uint32_t>();
    if (length > kMaxTextBytes || length > bytes.size() - at) {
      ok = false;
      return {};
    }
    at += length;
    return std::string(bytes.substr(at - length, length));
  }
};

void append_nominal(std::string& to, const NominalPose& pose) {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      append(to, pose.tablet_from_scanner.rotation(r, c));
    }
  }
  append_vector(to, pose.tablet_from_scanner.translation_mm);
  append(to, static_cast<std::int32_t>(pose.placement));
  for (const double sigma : {pose.sigma_mm, pose.sigma_rad, pose.hand_sigma_mm, pose.hand_sigma_rad}) {
    append(to, sigma);
  }
}

NominalPose read_nominal(FieldReader& fields) {
  NominalPose pose;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      pose.tablet_from_scanner.rotation(r, c) = fields.finite();
    }
  }
  pose.tablet_from_scanner.translation_mm = fields.vector();
  pose.placement = fields.next<std::int32_t>();
  for (double* sigma : {&pose.sigma_mm, &pose.sigma_rad, &pose.hand_sigma_mm, &pose.hand_sigma_rad}) {
    *sigma = fields.finite();
  }
  return pose;
}

/// Mask, x, y, z and the optional arrays.
std::size_t chunk_count(std::uint32_t parts) {
  std::size_t count = 4;
  for (const std::uint32_t part : {kGridHasIntensity, kGridHasConfidence, kGridHasColour}) {
    count += (parts & part) != 0 ? 1 : 0;
  }
  return count;
}

}  // namespace

Status check_grid_prelude(std::string_view file, const std::string& where) {
  if (file.empty()) {
    return bad_input(where, "the file is empty", kRestore);
  }
  if (!is_grid_file(file)) {
    return bad_input(where, "not a grid file of Dubsar (its first bytes are others)",
                     "check what the file is");
  }
  if (file.size() < kGridPreludeBytes) {
    return bad_input(where, "cut short within its first " + std::to_string(kGridPreludeBytes) + " bytes",
                     kRestore);
  }
  const auto version = load<std::uint32_t>(file.data() + 8);
  if (version != kGridVersion) {
    return bad_input(where,
                     "grid version " + std::to_string(version) +
                         " is not known (this program reads version " + std::to_string(kGridVersion) + ")",
                     "read it with the program that wrote it, or a newer one");
  }
  const auto file_bytes = load<std::uint64_t>(file.data() + 16);
  if (file_bytes != file.size()) {
    return bad_input(where,
                     (file.size() < file_bytes ? "cut short: " : "has bytes behind its end: ") +
                         std::to_string(file.size()) + " bytes instead of " + std::to_string(file_bytes),
                     kRestore);
  }
  const auto header_bytes = load<std::uint32_t>(file.data() + 12);
  if (header_bytes < kGridPreludeBytes || header_bytes + kGridChecksumBytes > file.size()) {
    return bad_input(where, "its header claims " + std::to_string(header_bytes) + " bytes", kRestore);
  }
  return {};
}

std::string encode_grid_header(const GridHeader& header) {
  const RangeGrid& grid = header.grid;
  std::string out(kGridMagic);
  append(out, kGridVersion);
  append(out, std::uint32_t{0});  // set below, once the length is known
  append(out, header.file_bytes);
  append(out, static_cast<std::uint32_t>(grid.rows));
  append(out, static_cast<std::uint32_t>(grid.cols));
  append(out, header.parts);
  append(out, header.valid_count);
  append(out, grid.spacing_mm);
  append(out, grid.pin_tip_diameter_mm);
  append(out, grid.timestamp_ns);
  append_vector(out, grid.view.direction);
  append_vector(out, grid.view.motion_per_row_mm);
  append_vector(out, grid.view.laser_mm.value_or(Eigen::Vector3d::Zero()));
  append_vector(out, grid.view.camera_mm.value_or(Eigen::Vector3d::Zero()));
  if (grid.nominal) {
    append_nominal(out, *grid.nominal);
  }
  append_text(out, grid.device);
  append_text(out, grid.source);
  for (const std::uint64_t bytes : header.chunk_bytes) {
    append(out, bytes);
  }
  std::string length;
  append(length, static_cast<std::uint32_t>(out.size()));
  out.replace(12, length.size(), length);
  return out;
}

Result<GridHeader> decode_grid_header(std::string_view file, const std::string& where) {
  if (Status prelude = check_grid_prelude(file, where); !prelude) {
    return std::unexpected(prelude.error());
  }
  GridHeader header;
  header.file_bytes = file.size();
  header.header_bytes = load<std::uint32_t>(file.data() + 12);
  FieldReader fields{file.substr(0, header.header_bytes), kGridPreludeBytes};
  const auto rows = fields.next<std::uint32_t>();
  const auto cols = fields.next<std::uint32_t>();
  header.parts = fields.next<std::uint32_t>();
  header.valid_count = fields.next<std::uint64_t>();
  RangeGrid& grid = header.grid;
  grid.spacing_mm = fields.finite();
  grid.pin_tip_diameter_mm = fields.finite();
  grid.timestamp_ns = fields.next<std::int64_t>();
  grid.view.direction = fields.vector();
  grid.view.motion_per_row_mm = fields.vector();
  const Eigen::Vector3d laser_mm = fields.vector();
  const Eigen::Vector3d camera_mm = fields.vector();
  if ((header.parts & kGridHasLaser) != 0) {
    grid.view.laser_mm = laser_mm;
  }
  if ((header.parts & kGridHasCamera) != 0) {
    grid.view.camera_mm = camera_mm;
  }
  if ((header.parts & kGridHasNominal) != 0) {
    grid.nominal = read_nominal(fields);
  }
  grid.device = fields.text();
  grid.source = fields.text();

  std::uint64_t left = file.size() - header.header_bytes - kGridChecksumBytes;
  for (std::size_t chunk = 0; chunk < chunk_count(header.parts); ++chunk) {
    header.chunk_bytes.push_back(fields.next<std::uint64_t>());
    fields.ok = fields.ok && header.chunk_bytes.back() <= left;
    left -= fields.ok ? header.chunk_bytes.back() : 0;
  }
  // The mask is stored as plain bits, so that it bounds what the grid may take by the bytes that are there.
  const std::uint64_t cells = std::uint64_t{rows} * cols;
  if (!fields.ok || fields.at != header.header_bytes || left != 0 || rows > 0x7fffffffU ||
      cols > 0x7fffffffU || header.chunk_bytes[0] != cells / 8 + (cells % 8 != 0 ? 1 : 0) ||
      header.valid_count > cells) {
    return bad_input(where, "the sizes in its header contradict each other", kRestore);
  }
  grid.rows = static_cast<int>(rows);
  grid.cols = static_cast<int>(cols);
  return header;
}

}  // namespace dubsar
