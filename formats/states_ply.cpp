// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/states_ply.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "core/utf8.h"
#include "formats/atomic_file.h"
#include "formats/byte_order.h"

namespace dubsar {

namespace {

/// By SampleState: clay, red, green, amber, violet, dark grey. Told apart by lightness too.
constexpr std::array<std::array<std::uint8_t, 3>, kSampleStateCount> kColours = {
    {{0, 0, 0}, {200, 186, 168}, {214, 30, 38}, {70, 140, 90}, {226, 160, 42}, {112, 72, 160}, {50, 50, 50}}};

constexpr std::string_view kBegin =
    "ply\nformat binary_little_endian 1.0\ncomment States of the samples of one scan, Dubsar\n";

std::int16_t small(int value) {
  return static_cast<std::int16_t>(std::clamp<int>(value, -1, std::numeric_limits<std::int16_t>::max()));
}

}  // namespace

std::string encode_states_ply(int scan_id, const RangeGrid& grid, const RigidTransform& model_from_scanner,
                              const SampleStates& states) {
  std::array<std::size_t, kSampleStateCount> counts{};
  for (const SampleState state : states.state) {
    ++counts[static_cast<std::size_t>(state)];
  }
  std::string out(kBegin);
  out += "obj_info unit mm\nobj_info scan " + std::to_string(scan_id) + "\nobj_info num_cols " +
         std::to_string(grid.cols) + "\nobj_info num_rows " + std::to_string(grid.rows) + "\n";
  if (!grid.source.empty()) {
    out += "obj_info file " + one_line(grid.source) + "\n";
  }
  for (std::size_t k = 1; k < counts.size(); ++k) {
    out += "obj_info state " + std::to_string(k) + " " + to_string(static_cast<SampleState>(k)) + " " +
           std::to_string(counts[k]) + "\n";
  }
  for (std::size_t k = 0; k < states.reasons.size(); ++k) {
    out += "obj_info reason " + std::to_string(k) + " " + one_line(states.reasons[k]) + "\n";
  }
  const std::size_t samples = states.state.size() - counts[0];
  out += "element vertex " + std::to_string(samples) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
         "property uchar blue\nproperty uchar state\nproperty short cleared_by\nproperty short reason\n"
         "property int cell\nend_header\n";
  out.reserve(out.size() + samples * 24);
  for (std::size_t i = 0; i < states.state.size(); ++i) {
    if (states.state[i] == SampleState::kNone) {
      continue;
    }
    const Eigen::Vector3f p = (model_from_scanner * grid.point(i).cast<double>()).cast<float>();
    for (const float value : {p.x(), p.y(), p.z()}) {
      append(out, value);
    }
    for (const std::uint8_t value : kColours[static_cast<std::size_t>(states.state[i])]) {
      append(out, value);
    }
    append(out, static_cast<std::uint8_t>(states.state[i]));
    append(out, small(states.cleared_by[i]));
    append(out, small(states.reason[i]));
    append(out, static_cast<std::int32_t>(i));
  }
  return out;
}

Status write_states_ply(const std::filesystem::path& path, int scan_id, const RangeGrid& grid,
                        const RigidTransform& model_from_scanner, const SampleStates& states) {
  return write_file_atomically(path, encode_states_ply(scan_id, grid, model_from_scanner, states));
}

bool is_states_ply(std::string_view head) {
  return head.starts_with(kBegin);
}

}  // namespace dubsar
