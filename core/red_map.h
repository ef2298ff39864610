// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/rig.h"
#include "core/rigid_transform.h"
#include "core/scan_copy.h"

namespace dubsar {

enum class Face { kObverse, kReverse, kLeft, kRight, kTop, kBottom };
inline constexpr int kFaceCount = 6;

[[nodiscard]] constexpr const char* to_string(Face face) {
  constexpr const char* kNames[] = {"obverse", "reverse", "left", "right", "top", "bottom"};
  return kNames[static_cast<int>(face)];
}
/// By Face.
[[nodiscard]] inline std::vector<std::string> face_names() {
  std::vector<std::string> names;
  names.reserve(kFaceCount);
  for (int face = 0; face < kFaceCount; ++face) {
    names.emplace_back(to_string(static_cast<Face>(face)));
  }
  return names;
}

enum class RegionState { kRed, kExcused };
enum class Excuse { kNone, kUnreachable, kUnneeded };

[[nodiscard]] constexpr const char* to_string(Excuse excuse) {
  constexpr const char* kNames[] = {"none", "unreachable", "unneeded"};
  return kNames[static_cast<int>(excuse)];
}

/// Counts of one scan's samples by state.
struct RedScan {
  int id = 0;
  std::int64_t samples = 0;
  std::int64_t potentially_sparse = 0;
  std::int64_t sparse = 0;  ///< still red
  std::int64_t cleared = 0;
  std::int64_t excused = 0;
};

/// A connected patch of red or excused samples in the model frame, with the hole that it borders.
struct RedRegion {
  Face face = Face::kObverse;
  Eigen::Vector3d center_mm{0, 0, 0};
  Eigen::Vector3d normal{0, 0, 1};  ///< out of the clay
  double area_mm2 = 0;              ///< of the hole that the red border encloses, estimated
  RegionState state = RegionState::kRed;
  Excuse excuse = Excuse::kNone;
  std::string reason;  ///< of the excuse; of a red one, why no view will clear it
};

/// A next placement, best first.
struct NextView {
  RigidTransform model_from_scanner;
  double predicted_cleared_mm2 = 0;
  std::string say;                     ///< words that an operator can follow
  std::optional<Placement> placement;  ///< set when the rig can be driven or the operator asked
};

/// Scans that fit one another and nothing of the model, such as those of the other side of a tablet.
struct GroupApart {
  std::vector<int> ids;  ///< two at least, ascending
  std::string say;       ///< that they do, and which view would join them: words that an operator can follow
};

/// What is still missing (seed 001, 3.3; design.md "Red map").
struct RedMap {
  bool conclusive = false;
  std::vector<RedScan> scans;
  std::vector<ScanCopy> copies;  ///< placed scans that count as one of `scans` and are not among them; by id
  std::vector<RedRegion> regions;
  std::vector<NextView> next;
  std::vector<GroupApart> apart;  ///< by their lowest id; what they saw counts as not seen
};

}  // namespace dubsar
