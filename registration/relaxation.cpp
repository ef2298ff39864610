// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/relaxation.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "core/disjoint_sets.h"
#include "core/order_statistics.h"
#include "registration/relaxation_covariance.h"

namespace dubsar {

namespace {

/// The scale of the loss follows from the last solution: a far start or a wrong pair makes the first too
/// wide.
constexpr int kPasses = 4;

/// Quaternion (x y z w) and translation of model_from_scanner, as Ceres moves them.
struct Block {
  std::array<double, 4> q{0, 0, 0, 1};
  std::array<double, 3> t{0, 0, 0};
};

Block to_block(const RigidTransform& pose) {
  const Eigen::Quaterniond q(pose.rotation);
  return {{q.x(), q.y(), q.z(), q.w()},
          {pose.translation_mm.x(), pose.translation_mm.y(), pose.translation_mm.z()}};
}

RigidTransform from_block(const Block& block) {
  const Eigen::Quaterniond q(block.q[3], block.q[0], block.q[1], block.q[2]);
  return {q.normalized().toRotationMatrix(), {block.t[0], block.t[1], block.t[2]}};
}

/// Whitened twist of a_from_b_measured · (a_from_b_now)⁻¹ about the centre in the frame of a.
struct PairCost {
  Eigen::Quaterniond measured_q;
  Eigen::Vector3d measured_t, center;
  Matrix6d root;

  template <class T>
  bool operator()(const T* qa_raw, const T* ta_raw, const T* qb_raw, const T* tb_raw, T* residual) const {
    using Quaternion = Eigen::Quaternion<T>;
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Quaternion qa = Eigen::Map<const Quaternion>(qa_raw);
    const Quaternion qb = Eigen::Map<const Quaternion>(qb_raw);
    const Vector ta = Eigen::Map<const Vector>(ta_raw);
    const Vector tb = Eigen::Map<const Vector>(tb_raw);
    // b_from_a, then a_from_b as measured.
    const Quaternion back_q = qb.conjugate() * qa;
    const Vector back_t = qb.conjugate() * (ta - tb);
    const Quaternion q = measured_q.cast<T>() * back_q;
    const Vector c = center.cast<T>();
    const Vector moved = measured_q.cast<T>() * (back_q * c + back_t) + measured_t.cast<T>();
    const T sign = q.w() < T(0) ? T(-2) : T(2);
    Eigen::Matrix<T, 6, 1> twist;
    twist << sign * q.vec(), moved - c;
    Eigen::Map<Eigen::Matrix<T, 6, 1>> out(residual);
    out = root.cast<T>() * twist;
    return true;
  }
};

/// The symmetric root of the information.
Matrix6d root_of(const Matrix6d& information) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(information);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

PairCost cost_of(const PairConstraint& pair) {
  return {Eigen::Quaterniond(pair.a_from_b.rotation), pair.a_from_b.translation_mm, pair.center_mm,
          root_of(pair.information)};
}

/// Mean square whitened residual of each pair: about 1 when the pairs agree as well as they claim.
std::vector<double> mean_squares(const std::vector<Block>& blocks, const std::vector<PairConstraint>& pairs) {
  std::vector<double> squares;
  for (const PairConstraint& pair : pairs) {
    Vector6d r;
    cost_of(pair)(blocks[pair.a].q.data(), blocks[pair.a].t.data(), blocks[pair.b].q.data(),
                  blocks[pair.b].t.data(), r.data());
    squares.push_back(r.squaredNorm() / 6.0);
  }
  return squares;
}

/// For the scale of the loss: the median, that wrong pairs do not move; at least 1.
double loss_factor(std::vector<double> squares) {
  if (squares.empty()) {
    return 1.0;
  }
  return std::max(1.0, median_of(std::move(squares)));
}

/// For the covariances: the variance of unit weight, of as many pairs as are more than a tree needs; at least
/// 1, and no pair counts for more than an outlier's share.
double variance_factor(const std::vector<double>& squares, std::size_t free_scans) {
  constexpr double kOutlier = 25.0;
  if (squares.size() <= free_scans) {
    return 1.0;
  }
  double sum = 0;
  for (const double s : squares) {
    sum += std::min(s, kOutlier);
  }
  return std::max(1.0, sum / static_cast<double>(squares.size() - free_scans));
}

/// What does not move: the fixed scans, and the first of the largest piece that pairs connect, where none of
/// it is fixed.
std::vector<bool> held_scans(const std::vector<bool>& fixed, const std::vector<PairConstraint>& pairs) {
  DisjointSets pieces(fixed.size());
  for (const PairConstraint& pair : pairs) {
    pieces.unite(static_cast<std::uint32_t>(pair.a), static_cast<std::uint32_t>(pair.b));
  }
  std::vector<std::size_t> sizes(fixed.size(), 0);
  for (std::uint32_t k = 0; k < fixed.size(); ++k) {
    ++sizes[pieces.root(k)];
  }
  std::vector<bool> held = fixed;
  const auto largest = static_cast<std::uint32_t>(std::ranges::max_element(sizes) - sizes.begin());
  bool is_held = false;
  for (std::uint32_t k = 0; k < fixed.size(); ++k) {
    is_held = is_held || (fixed[k] && pieces.root(k) == largest);
  }
  if (!fixed.empty() && !is_held) {
    held[largest] = true;  // a root is the first of its piece
  }
  return held;
}

/// What would make Ceres fail with a word that nobody understands, or give poses that are none.
Status check(const std::vector<RigidTransform>& start, const std::vector<bool>& fixed,
             const std::vector<Eigen::Vector3d>& centers_mm, const std::vector<PairConstraint>& pairs) {
  if (fixed.size() != start.size() || centers_mm.size() != start.size()) {
    return fail(ErrorKind::kInternal, "relaxation: as many fixed marks and centres as poses are needed");
  }
  for (std::size_t k = 0; k < start.size(); ++k) {
    if (!start[k].is_rigid() || !centers_mm[k].allFinite()) {
      return fail(ErrorKind::kInternal,
                  "relaxation: the pose of scan " + std::to_string(k) + " of the group is not rigid");
    }
  }
  for (const PairConstraint& pair : pairs) {
    const bool known = pair.a < start.size() && pair.b < start.size() && pair.a != pair.b;
    if (!known || !pair.a_from_b.is_rigid() || !pair.center_mm.allFinite() || !pair.information.allFinite()) {
      return fail(ErrorKind::kInternal, "relaxation: what scans " + std::to_string(pair.a) + " and " +
                                            std::to_string(pair.b) +
                                            " of the group say of each other is not finite");
    }
  }
  return {};
}

}  // namespace

PairConstraint turned(const PairConstraint& pair) {
  PairConstraint out = pair;
  std::swap(out.a, out.b);
  std::swap(out.of_a, out.of_b);
  out.a_from_b = pair.a_from_b.inverse();
  out.center_mm = out.a_from_b * pair.center_mm;
  // The opposite motion about the same place, in the other scan's frame.
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = out.a_from_b.rotation;
  turn.bottomRightCorner<3, 3>() = out.a_from_b.rotation;
  out.information = turn * pair.information * turn.transpose();
  return out;
}

Result<std::vector<RelaxedPose>> relax(const std::vector<RigidTransform>& start,
                                       const std::vector<bool>& fixed,
                                       const std::vector<Eigen::Vector3d>& centers_mm,
                                       const std::vector<PairConstraint>& pairs,
                                       const RelaxationOptions& options, const JobContext& job) {
  const std::size_t count = start.size();
  if (Status sound = check(start, fixed, centers_mm, pairs); !sound) {
    return std::unexpected(sound.error());
  }
  const std::vector<bool> held = held_scans(fixed, pairs);
  std::vector<Block> blocks;
  blocks.reserve(count);
  for (const RigidTransform& pose : start) {
    blocks.push_back(to_block(pose));
  }
  const auto free_scans = static_cast<std::size_t>(std::count(held.begin(), held.end(), false));
  for (int pass = 0; pass < kPasses && !pairs.empty() && free_scans > 0; ++pass) {
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "relaxation was stopped");
    }
    const double factor = loss_factor(mean_squares(blocks, pairs));
    ceres::Problem problem;
    for (const PairConstraint& pair : pairs) {
      auto* cost = new ceres::AutoDiffCostFunction<PairCost, 6, 4, 3, 4, 3>(new PairCost(cost_of(pair)));
      auto* loss = new ceres::HuberLoss(options.huber_sigmas * std::sqrt(6.0 * factor));
      problem.AddResidualBlock(cost, loss, blocks[pair.a].q.data(), blocks[pair.a].t.data(),
                               blocks[pair.b].q.data(), blocks[pair.b].t.data());
    }
    for (std::size_t k = 0; k < count; ++k) {
      if (!problem.HasParameterBlock(blocks[k].q.data())) {
        continue;
      }
      problem.SetManifold(blocks[k].q.data(), new ceres::EigenQuaternionManifold());
      if (held[k]) {
        problem.SetParameterBlockConstant(blocks[k].q.data());
        problem.SetParameterBlockConstant(blocks[k].t.data());
      }
    }
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    solver.num_threads = 1;
    solver.max_num_iterations = options.iterations;
    solver.function_tolerance = 1e-12;
    solver.parameter_tolerance = 1e-12;
    solver.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (!summary.IsSolutionUsable()) {
      return fail(ErrorKind::kInternal, "relaxation found no solution: " + summary.message);
    }
  }
  const double factor = variance_factor(mean_squares(blocks, pairs), free_scans);

  std::vector<RelaxedPose> out(count);
  for (std::size_t k = 0; k < count; ++k) {
    out[k].model_from_scanner = held[k] ? start[k] : from_block(blocks[k]);
  }
  return set_covariances(out, held, centers_mm, pairs, factor, options.shared_noise)
             ? Result<std::vector<RelaxedPose>>(std::move(out))
             : fail(ErrorKind::kInternal, "relaxation: the pairs give no covariance");
}

}  // namespace dubsar
