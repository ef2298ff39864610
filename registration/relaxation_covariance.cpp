// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/relaxation_covariance.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <tuple>

namespace dubsar {

namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Takes a twist about the model's origin to the twist about `center` of the same motion, both in the model
/// frame; about any other place, too, from which `center` is so far off.
Matrix6d about(const Eigen::Vector3d& center) {
  Matrix6d m = Matrix6d::Identity();
  m.bottomLeftCorner<3, 3>() = -cross_matrix(center);
  return m;
}

/// The pair's information on the difference of its scans' twists about the model's origin.
Matrix6d in_model(const PairConstraint& pair, const RigidTransform& model_from_a) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = model_from_a.rotation.transpose();
  turn.bottomRightCorner<3, 3>() = model_from_a.rotation.transpose();
  const Matrix6d j = turn * about(model_from_a * pair.center_mm);
  return j.transpose() * pair.information * j;
}

/// K with K Kᵀ = information / 2, whose columns mean the same motions for all pairs of one scan: the
/// symmetric root about the scan's centre, turns and shifts brought to one scale.
Matrix6d half_root(const Matrix6d& information, const Eigen::Vector3d& center_mm) {
  const Matrix6d to_center = about(center_mm);
  const Matrix6d from_center = to_center.inverse();
  const Matrix6d local = from_center.transpose() * information * from_center;
  const double radius_mm = std::sqrt(local.topLeftCorner<3, 3>().trace() /
                                     std::max(local.bottomRightCorner<3, 3>().trace(), 1e-300));
  Vector6d scale = Vector6d::Ones();
  scale.head<3>().setConstant(std::max(radius_mm, 1e-6));
  const Matrix6d scaled = scale.cwiseInverse().asDiagonal() * local * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(0.5 * scaled);
  return to_center.transpose() * scale.asDiagonal() * eigen.eigenvectors() *
         eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
}

/// A scan's noise in one of its pairs: half_root(), acting on this scan and, the other way, on the other. A
/// place below 0: that scan is held.
struct Share {
  Matrix6d root;
  int place = -1, other = -1;
  const Footprint* footprint = nullptr;
};

/// What the pairs of one scan have in common, two by two.
void add_shared(const std::vector<Share>& shares, double shared_noise, Eigen::MatrixXd& pull) {
  for (const Share& p : shares) {
    for (const Share& q : shares) {
      if (&p == &q) {
        continue;  // is in the pair's own
      }
      const Matrix6d both =
          shared_noise * in_common(*p.footprint, *q.footprint) * p.root * q.root.transpose();
      for (const auto& [row, col, sign] : {std::tuple{p.place, q.place, 1.0},
                                           {p.other, q.other, 1.0},
                                           {p.place, q.other, -1.0},
                                           {p.other, q.place, -1.0}}) {
        if (row >= 0 && col >= 0) {
          pull.block<6, 6>(row, col) += sign * both;
        }
      }
    }
  }
}

}  // namespace

Matrix6d about_place(const Matrix6d& covariance, const Eigen::Vector3d& off_mm) {
  const Matrix6d to_place = about(off_mm);
  return to_place * covariance * to_place.transpose();
}

bool set_covariances(std::vector<RelaxedPose>& poses, const std::vector<bool>& held,
                     const std::vector<Eigen::Vector3d>& centers_mm, const std::vector<PairConstraint>& pairs,
                     double variance_factor, double shared_noise) {
  std::vector<int> place(poses.size(), -1);
  int unknowns = 0;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (!held[k]) {
      place[k] = 6 * unknowns++;
    }
  }
  if (unknowns == 0) {
    return true;
  }
  // What is known beforehand is next to nothing, but it makes what no pair tells very uncertain.
  const Eigen::MatrixXd known = 1e-9 * Eigen::MatrixXd::Identity(6 * unknowns, 6 * unknowns);
  Eigen::MatrixXd normal = known;
  Eigen::MatrixXd pull = known;
  std::vector<std::vector<Share>> of_scan(poses.size());
  for (const PairConstraint& pair : pairs) {
    const Matrix6d h = in_model(pair, poses[pair.a].model_from_scanner) / variance_factor;
    const int pa = place[pair.a];
    const int pb = place[pair.b];
    for (const auto& [row, col, sign] :
         {std::tuple{pa, pa, 1.0}, {pb, pb, 1.0}, {pa, pb, -1.0}, {pb, pa, -1.0}}) {
      if (row >= 0 && col >= 0) {
        normal.block<6, 6>(row, col) += sign * h;
        pull.block<6, 6>(row, col) += sign * h;
      }
    }
    for (const std::size_t scan : {pair.a, pair.b}) {
      if (!pair.from_surfaces) {
        break;
      }
      const Matrix6d k = half_root(h, poses[scan].model_from_scanner * centers_mm[scan]);
      const bool is_a = scan == pair.a;
      of_scan[scan].push_back(
          {k, place[scan], place[is_a ? pair.b : pair.a], is_a ? &pair.of_a : &pair.of_b});
    }
  }
  for (const std::vector<Share>& shares : of_scan) {
    add_shared(shares, shared_noise, pull);
  }
  const Eigen::LDLT<Eigen::MatrixXd> factored = normal.ldlt();
  const Eigen::MatrixXd half = factored.solve(pull);
  const Eigen::MatrixXd covariance = factored.solve(half.transpose());
  if (!covariance.allFinite()) {
    return false;
  }
  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (place[k] >= 0) {
      const Matrix6d to_center = about(poses[k].model_from_scanner * centers_mm[k]);
      const Matrix6d block = covariance.block<6, 6>(place[k], place[k]);
      poses[k].covariance = to_center * (0.5 * (block + block.transpose())) * to_center.transpose();
    }
  }
  return true;
}

}  // namespace dubsar
