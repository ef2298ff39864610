// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/tablet_size.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace dubsar {
namespace {

constexpr double kLeastMm = 6;
constexpr double kMostMm = 800;
/// A kilometre: beyond, areas leave what a float can tell.
constexpr double kMostAcrossMm = 1e6;
/// What the fits believe at best (inner_edges.cpp): coarser places would decide what is measured.
constexpr double kCoarsestPlaceMm = 0.004;

Eigen::AlignedBox3f box_in_use(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const auto& f : mesh.faces) {
    for (const std::uint32_t v : f) {
      if (v < mesh.positions.size() && mesh.positions[v].allFinite()) {
        box.extend(mesh.positions[v]);
      }
    }
  }
  return box;
}

}  // namespace

Eigen::Vector3d size_mm(const Mesh& mesh) {
  const Eigen::AlignedBox3f box = box_in_use(mesh);
  return box.isEmpty() ? Eigen::Vector3d::Zero().eval() : box.sizes().cast<double>().eval();
}

double size_across_mm(const Mesh& mesh) {
  return size_mm(mesh).norm();
}

bool is_inscribed_size(double across_mm) {
  return across_mm >= kLeastMm && across_mm <= kMostMm;
}

std::vector<std::string_view> likelier_units(double across_mm, double mm_per_number) {
  constexpr std::array<std::pair<std::string_view, double>, 5> kUnits = {
      {{"mm", 1.0}, {"m", 1000.0}, {"um", 0.001}, {"cm", 10.0}, {"in", 25.4}}};
  std::vector<std::string_view> likelier;
  for (const auto& [name, mm] : kUnits) {
    if (across_mm > 0 && !is_inscribed_size(across_mm) && is_inscribed_size(across_mm / mm_per_number * mm)) {
      likelier.push_back(name);
    }
  }
  return likelier;
}

std::optional<std::string_view> likely_unit(double across_mm, double mm_per_number) {
  for (const std::string_view unit : likelier_units(across_mm, mm_per_number)) {
    if (unit == "m" || unit == "mm" || unit == "um") {
      return unit;
    }
  }
  return std::nullopt;
}

double coarsest_place_mm(const Mesh& mesh) {
  const Eigen::AlignedBox3f box = box_in_use(mesh);
  if (box.isEmpty()) {
    return 0;
  }
  const float far_mm = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
  return std::nextafter(far_mm, std::numeric_limits<float>::infinity()) - far_mm;
}

Status check_measurable(const Mesh& mesh, const std::string& where) {
  if (const double across_mm = size_across_mm(mesh); !(across_mm < kMostAcrossMm)) {
    return bad_input(where, fmt::format("it would be {:.3g} mm across", across_mm),
                     "nothing inscribed is that large: look what its numbers are and give their unit");
  }
  if (const double coarse_mm = coarsest_place_mm(mesh); coarse_mm > kCoarsestPlaceMm) {
    return bad_input(
        where,
        fmt::format("it lies so far from the origin of its numbers that places are good to {:.2g} mm only",
                    coarse_mm),
        "export it again with its middle at the origin");
  }
  return {};
}

}  // namespace dubsar
