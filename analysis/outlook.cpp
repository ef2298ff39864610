// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/outlook.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "core/parallel.h"

namespace dubsar {

namespace {

using Cell = std::array<std::int32_t, 3>;
constexpr std::size_t kGrain = 1U << 14U;
constexpr double kFarthestCell = 1e9;

struct CellHash {
  std::size_t operator()(const Cell& c) const {
    std::uint64_t h = 0;
    for (const std::int32_t k : c) {
      h = (h ^ static_cast<std::uint32_t>(k)) * 0x9e3779b97f4a7c15U;
      h ^= h >> 29U;
    }
    return static_cast<std::size_t>(h);
  }
};

using Sums = std::unordered_map<Cell, Eigen::Vector3d, CellHash>;

Cell cell_of(const Eigen::Vector3d& in_cells) {
  return {static_cast<std::int32_t>(std::floor(in_cells.x())),
          static_cast<std::int32_t>(std::floor(in_cells.y())),
          static_cast<std::int32_t>(std::floor(in_cells.z()))};
}

/// Area vectors of the faces, by the cell that the middle of the face lies in. In the order of the faces.
Sums area_by_cell(const Mesh& mesh, double radius_mm) {
  Sums sums;
  Cell last{};
  Eigen::Vector3d* into = nullptr;
  for (const auto& face : mesh.faces) {
    if (std::ranges::any_of(face, [&](std::uint32_t v) { return v >= mesh.positions.size(); })) {
      continue;
    }
    const Eigen::Vector3d a = mesh.positions[face[0]].cast<double>();
    const Eigen::Vector3d b = mesh.positions[face[1]].cast<double>();
    const Eigen::Vector3d c = mesh.positions[face[2]].cast<double>();
    const Eigen::Vector3d area = (b - a).cross(c - a);
    const Eigen::Vector3d at = (a + b + c) / (3 * radius_mm);
    if (!area.allFinite() || !at.allFinite() || at.cwiseAbs().maxCoeff() > kFarthestCell) {
      continue;
    }
    const Cell cell = cell_of(at);
    if (into == nullptr || cell != last) {  // neighbouring faces mostly lie in the same cell
      into = &sums.try_emplace(cell, Eigen::Vector3d::Zero()).first->second;
      last = cell;
    }
    *into += area;
  }
  return sums;
}

/// The 27 cells about one, so that the next vertex in the same cell need not look them up.
class Neighbourhood {
 public:
  explicit Neighbourhood(const Sums& sums) : sums_(sums) {}

  /// Blended by a quadratic B-spline about the cells' middles: smooth from cell to cell.
  [[nodiscard]] Eigen::Vector3d mean_at(const Eigen::Vector3d& in_cells) {
    const Cell middle = cell_of(in_cells);
    if (!filled_ || middle != middle_) {
      fill(middle);
    }
    Eigen::Matrix3d weight;  // by axis and cell
    for (int axis = 0; axis < 3; ++axis) {
      const double past = in_cells[axis] - (middle_[static_cast<std::size_t>(axis)] + 0.5);
      weight(axis, 0) = 0.5 * (0.5 - past) * (0.5 - past);
      weight(axis, 1) = 0.75 - past * past;
      weight(axis, 2) = 0.5 * (0.5 + past) * (0.5 + past);
    }
    Eigen::Vector3d sum(0, 0, 0);
    for (std::size_t k = 0; k < around_.size(); ++k) {
      if (around_[k] != nullptr) {
        const auto i = static_cast<Eigen::Index>(k);
        sum += weight(0, i % 3) * weight(1, i / 3 % 3) * weight(2, i / 9) * *around_[k];
      }
    }
    return sum;
  }

 private:
  void fill(const Cell& middle) {
    middle_ = middle;
    filled_ = true;
    for (std::int32_t k = 0; k < 27; ++k) {
      const auto found =
          sums_.find({middle[0] + k % 3 - 1, middle[1] + k / 3 % 3 - 1, middle[2] + k / 9 - 1});
      around_[static_cast<std::size_t>(k)] = found == sums_.end() ? nullptr : &found->second;
    }
  }

  const Sums& sums_;
  Cell middle_{};
  bool filled_ = false;
  std::array<const Eigen::Vector3d*, 27> around_{};
};

}  // namespace

std::vector<Eigen::Vector3f> mean_outlook(const Mesh& mesh, double radius_mm) {
  std::vector<Eigen::Vector3f> outlook(mesh.positions.size(), Eigen::Vector3f::Zero());
  const Sums sums = area_by_cell(mesh, radius_mm);
  parallel_chunks(mesh.positions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    Neighbourhood around(sums);
    for (std::size_t v = begin; v < end; ++v) {
      const Eigen::Vector3d at = mesh.positions[v].cast<double>() / radius_mm;
      if (!at.allFinite() || at.cwiseAbs().maxCoeff() > kFarthestCell) {
        continue;
      }
      const Eigen::Vector3d sum = around.mean_at(at);
      if (const double length = sum.norm(); length > 0) {
        outlook[v] = (sum / length).cast<float>();
      }
    }
  });
  return outlook;
}

}  // namespace dubsar
