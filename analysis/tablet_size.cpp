// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/tablet_size.h"

#include <Eigen/Geometry>

#include "core/units.h"

namespace dubsar {
namespace {

constexpr double kLeastMm = 6;
constexpr double kMostMm = 800;

bool plausible(double across_mm) {
  return across_mm >= kLeastMm && across_mm <= kMostMm;
}

}  // namespace

double size_across_mm(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const auto& f : mesh.faces) {
    for (const std::uint32_t v : f) {
      if (v < mesh.positions.size() && mesh.positions[v].allFinite()) {
        box.extend(mesh.positions[v]);
      }
    }
  }
  return box.isEmpty() ? 0.0 : static_cast<double>(box.diagonal().norm());
}

std::optional<std::string_view> likelier_unit(double across_mm, double mm_per_number) {
  if (!(across_mm > 0) || plausible(across_mm)) {
    return std::nullopt;
  }
  for (const std::string_view unit : {"mm", "m", "um"}) {
    if (plausible(across_mm / mm_per_number * *mm_per_unit(unit))) {
      return unit;
    }
  }
  return std::nullopt;
}

}  // namespace dubsar
