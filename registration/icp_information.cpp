// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/icp_information.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace dubsar {

namespace {

/// Side of a block of surface, of the rms radius of the pairs: far longer than residuals stay alike, and yet
/// a scan has some hundred.
constexpr double kBlockOfRadius = 1.0 / 6.0;
/// The least side, in spacings.
constexpr double kLeastBlockSpacings = 6.0;
/// Fewer blocks than this tell nothing of a covariance of six.
constexpr int kLeastBlocks = 12;
/// Normals are alike within one over so much, per axis: some 30 degrees.
constexpr double kSlopeBins = 2.0;
/// What sampling leaves however many samples there are, of the spacing (dubsar-pairs --simulated).
constexpr double kSystematicOfSpacing = 0.003;

/// Pulls that share a cause: what they are grouped by.
using GroupKey = std::array<int, 7>;
struct Keyed {
  GroupKey key;
  std::size_t term;
};

/// Sum over groups of (sum of the pulls)(sum of the pulls)ᵀ, and how many groups there are. Sorts `keyed`.
std::pair<Matrix6d, int> group_meat(const std::vector<PullTerm>& terms, std::vector<Keyed>& keyed) {
  std::sort(keyed.begin(), keyed.end(),
            [](const Keyed& a, const Keyed& b) { return a.key != b.key ? a.key < b.key : a.term < b.term; });
  Matrix6d meat = Matrix6d::Zero();
  int groups = 0;
  for (std::size_t k = 0; k < keyed.size();) {
    Vector6d sum = Vector6d::Zero();
    const GroupKey key = keyed[k].key;
    for (; k < keyed.size() && keyed[k].key == key; ++k) {
      sum += terms[keyed[k].term].pull;
    }
    meat.noalias() += sum * sum.transpose();
    ++groups;
  }
  return {meat, groups};
}

/// Units in which turns and shifts compare: displacement at the rms radius.
Vector6d unit_displacement(double radius_mm) {
  Vector6d scale;
  scale << Eigen::Vector3d::Constant(1.0 / radius_mm), Eigen::Vector3d::Ones();
  return scale;
}

/// The part of a symmetric matrix that is a covariance.
Matrix6d positive_part(const Matrix6d& m, double radius_mm) {
  const Vector6d scale = unit_displacement(radius_mm);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scale.asDiagonal() * m * scale.asDiagonal());
  const Matrix6d kept = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
                        eigen.eigenvectors().transpose();
  const Vector6d back = scale.cwiseInverse();
  return back.asDiagonal() * kept * back.asDiagonal();
}

/// Variance of the total pull, from two ways in which pulls are alike: by place (blocks of side_mm), and by
/// the slope of the surface, for what a scanner does to every flank that faces one way (Cameron, Gelbach and
/// Miller 2011). With it, how many blocks there are.
std::pair<Matrix6d, int> meat_of(const std::vector<PullTerm>& terms, double side_mm, double radius_mm) {
  std::vector<Keyed> by_place;
  std::vector<Keyed> by_slope;
  std::vector<Keyed> by_both;
  for (std::size_t k = 0; k < terms.size(); ++k) {
    if (terms[k].used) {
      const Eigen::Vector3i block = (terms[k].at_mm / side_mm).array().floor().cast<int>();
      const Eigen::Vector3i slope = (terms[k].normal * kSlopeBins).array().round().cast<int>();
      const int crease = terms[k].crease ? 1 : 0;
      by_place.push_back({{block.x(), block.y(), block.z(), 0, 0, 0, 0}, k});
      by_slope.push_back({{0, 0, 0, slope.x(), slope.y(), slope.z(), crease}, k});
      by_both.push_back({{block.x(), block.y(), block.z(), slope.x(), slope.y(), slope.z(), crease}, k});
    }
  }
  const auto [place, blocks] = group_meat(terms, by_place);
  const Matrix6d slope = group_meat(terms, by_slope).first;
  const Matrix6d both = group_meat(terms, by_both).first;
  return {place + positive_part(slope - both, radius_mm), blocks};
}

}  // namespace

FitInformation fit_information(const Matrix6d& slope, const std::vector<PullTerm>& terms,
                               const PullScale& scale) {
  const double side_mm = std::max(kBlockOfRadius * scale.radius_mm, kLeastBlockSpacings * scale.spacing_mm);
  const auto [meat, blocks] = meat_of(terms, side_mm, scale.radius_mm);
  if (blocks < kLeastBlocks) {
    return {Matrix6d::Zero(), blocks};
  }
  const Vector6d unit = unit_displacement(scale.radius_mm);
  const Matrix6d h = unit.asDiagonal() * slope * unit.asDiagonal();
  Matrix6d m = unit.asDiagonal() * meat * unit.asDiagonal();
  // Directions in which next to nothing pulls get no information out of rounding.
  m.diagonal().array() += 1e-9 * m.trace();
  // The inverse of a covariance estimated from n independent blocks is too large by n / (n - 7) (the mean of
  // the inverse Wishart distribution).
  m *= blocks / (blocks - 7.0);
  // (h⁻¹ m h⁻ᵀ + s²)⁻¹ without inverting h, which may be singular: hᵀ (m + s² h hᵀ)⁻¹ h.
  const double systematic_mm = kSystematicOfSpacing * scale.spacing_mm;
  const Matrix6d whole = m + systematic_mm * systematic_mm * h * h.transpose();
  const Matrix6d information = h.transpose() * whole.ldlt().solve(h);
  const Vector6d back = unit.cwiseInverse();
  return {back.asDiagonal() * (0.5 * (information + information.transpose())) * back.asDiagonal(), blocks};
}

Vector6d held_step(const Matrix6d& slope, const Vector6d& pull, double weight, double radius_mm,
                   double most_mm) {
  const Vector6d unit = unit_displacement(radius_mm);
  const Matrix6d a = unit.asDiagonal() * (0.5 * (slope + slope.transpose())) * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(a);
  const Vector6d inverse = eigen.eigenvalues().cwiseMax(1e-3 * weight).cwiseInverse();
  Vector6d step = -(eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose() *
                    (unit.asDiagonal() * pull));
  if (step.norm() > most_mm) {
    step *= most_mm / step.norm();
  }
  return unit.asDiagonal() * step;
}

}  // namespace dubsar
