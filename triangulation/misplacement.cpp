// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/misplacement.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/disjoint_sets.h"
#include "core/order_statistics.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

using Eigen::Vector3d;

/// Less than this of µ along the normal may come of how samples lie on the surface, not of poses.
constexpr double kLeastOfSpacing = 0.2;
constexpr double kSignificance = 4.0;
/// Motions are held to be no larger than this, unless steps say so.
constexpr double kUsualOfSpacing = 4.0;
/// So much more is known of where a fixed scan lies than steps to the others tell.
constexpr double kFixedOfInformation = 1e8;
/// So much of a motion may be wrong, and so many times the variance of a mean is that of where the scans are
/// taken together; by simulated tablets with poses that are off by 1 to 4 µ.
constexpr double kLeftOfMotion = 0.2;
constexpr double kOfMean = 2.0;

/// Scans that hang together by links, and the motions about one place, turns × `arm_mm`, that take each to
/// where the others have it.
class Group {
 public:
  Group(std::vector<std::size_t> members, std::span<const StitchSurface* const> scans)
      : members_(std::move(members)), scans_(scans), place_(scans.size()) {
    Eigen::AlignedBox3f box;
    for (std::size_t k = 0; k < members_.size(); ++k) {
      place_[members_[k]] = k;
      box.extend(scan(k).box);
      spacing_mm_ = std::max(spacing_mm_, scan(k).spacing_mm);
    }
    about_mm_ = box.center().cast<double>();
    arm_mm_ = std::max(0.5 * static_cast<double>(box.diagonal().norm()), spacing_mm_);
    blocks_.assign(members_.size(), MotionMatrix::Zero());
    right_ = Eigen::VectorXd::Zero(rows());
  }

  void add(const PoseLink& link) {
    const MotionMatrix turn = to_place_of(link.step);
    const double weight = 1.0 / (kDistancesPerIndependent * link.step.variance_mm2);
    const MotionMatrix information = weight * turn.transpose() * link.step.information * turn;
    const Motion right = weight * turn.transpose() * link.step.right;
    const std::size_t a = place_[link.a], b = place_[link.b];
    blocks_[a] += information;
    blocks_[b] += information;
    // The motion that takes a onto b is a's less b's.
    right_.segment<6>(at(a)) += right;
    right_.segment<6>(at(b)) -= right;
    for (int row = 0; row < 6; ++row) {
      for (int col = 0; col < 6; ++col) {
        beside_.emplace_back(at(std::max(a, b)) + row, at(std::min(a, b)) + col, -information(row, col));
      }
    }
  }

  void write_misplacements(std::vector<Misplacement>& out) {
    constexpr int kRounds = 10;
    std::vector<MotionMatrix> moments(members_.size());
    parallel_for_each_index(
        members_.size(), [&](std::size_t k) { moments[k] = moments_of(scan(k)); }, 1);
    std::vector<double> sizes(members_.size(), kUsualOfSpacing * spacing_mm_);
    Eigen::VectorXd motions;
    for (int round = 0; round < kRounds; ++round) {
      motions = solved(sizes);
      for (std::size_t k = 0; k < members_.size(); ++k) {
        const Motion motion = motions.segment<6>(at(k));
        sizes[k] = std::sqrt(3.0 * std::max(0.0, motion.dot(moments[k] * motion)));
      }
    }
    // Nothing tells how all lie together: the mean of so many errors, by what the fewest motions differ by or
    // by what is told of the poses, which counts as well where the scans happen to agree.
    const double count = static_cast<double>(members_.size());
    const double together2 = std::max(kOfMean * std::pow(median_of(sizes), 2) / (count - 1),
                                      std::pow(median_of(told_mm()), 2) / count);
    bool any_moves = false;
    for (std::size_t k = 0; k < members_.size(); ++k) {
      const double error2 = 3.0 * (moments[k] * inverse_of(k)).trace();
      if (sizes[k] > std::sqrt(3.0) * kLeastOfSpacing * scan(k).spacing_mm &&
          sizes[k] * sizes[k] > kSignificance * kSignificance * error2) {
        const Motion motion = motions.segment<6>(at(k));
        out[members_[k]] = {{about_mm_.cast<float>(), (motion.head<3>() / arm_mm_).cast<float>(),
                             motion.tail<3>().cast<float>()},
                            std::sqrt(kLeftOfMotion * kLeftOfMotion * sizes[k] * sizes[k] + error2)};
        any_moves = true;
      }
    }
    for (const std::size_t member : members_) {  // those that stay where they are are as far off together
      out[member].together_mm = any_moves ? std::sqrt(together2) : 0;
    }
  }

 private:
  [[nodiscard]] const StitchSurface& scan(std::size_t k) const { return *scans_[members_[k]]; }
  /// What is told of each pose; where nothing is, 0.
  [[nodiscard]] std::vector<double> told_mm() const {
    std::vector<double> out(members_.size());
    for (std::size_t k = 0; k < members_.size(); ++k) {
      const double told = scan(k).told_pose_sigma_mm;
      out[k] = std::isfinite(told) ? told : 0;
    }
    return out;
  }
  [[nodiscard]] static Eigen::Index at(std::size_t k) { return 6 * static_cast<Eigen::Index>(k); }
  [[nodiscard]] Eigen::Index rows() const { return at(members_.size()); }

  /// From this group's motions to motions about the step's own place.
  [[nodiscard]] MotionMatrix to_place_of(const PoseStep& step) const {
    MotionMatrix turn = MotionMatrix::Identity();
    turn.topLeftCorner<3, 3>() /= arm_mm_;
    const Vector3d d = step.about_mm - about_mm_;
    Eigen::Matrix3d cross;  // ω × d = -d × ω
    cross << 0, d.z(), -d.y(), -d.z(), 0, d.x(), d.y(), -d.x(), 0;
    turn.bottomLeftCorner<3, 3>() = cross / arm_mm_;
    return turn;
  }

  /// Mean of J Jᵀ over the scan's surface.
  [[nodiscard]] MotionMatrix moments_of(const StitchSurface& s) const {
    MotionMatrix sum = MotionMatrix::Zero();
    double count = 0;
    for (const std::int32_t sample : s.node_sample) {
      if (sample >= 0) {
        const auto i = static_cast<std::size_t>(sample);
        Motion row = motion_row(s.points[i].cast<double>(), s.normal(i).cast<double>(), about_mm_);
        row.head<3>() /= arm_mm_;
        sum.noalias() += row * row.transpose();
        ++count;
      }
    }
    return sum / std::max(count, 1.0);
  }

  /// `sizes`: of the motions of the round before. Their sum of sizes, not of squares, is held small: one scan
  /// that is off moves, not all others.
  [[nodiscard]] Eigen::VectorXd solved(const std::vector<double>& sizes) {
    const double usual_mm = kUsualOfSpacing * spacing_mm_;
    std::vector<Eigen::Triplet<double>> entries = beside_;
    held_.resize(members_.size());
    for (std::size_t k = 0; k < members_.size(); ++k) {
      held_[k] = blocks_[k];
      held_[k].diagonal().array() += 1.0 / (usual_mm * std::max(sizes[k], 0.01 * spacing_mm_));
      if (scan(k).is_fixed) {
        held_[k].diagonal().array() += kFixedOfInformation * held_[k].trace();
      }
      for (int row = 0; row < 6; ++row) {
        for (int col = 0; col <= row; ++col) {
          entries.emplace_back(at(k) + row, at(k) + col, held_[k](row, col));
        }
      }
    }
    Eigen::SparseMatrix<double> system(rows(), rows());
    system.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor(system);
    return factor.solve(right_);
  }

  /// The covariance of one scan's motion, the others' held.
  [[nodiscard]] MotionMatrix inverse_of(std::size_t k) const {
    return held_[k].ldlt().solve(MotionMatrix::Identity());
  }

  std::vector<std::size_t> members_;
  std::span<const StitchSurface* const> scans_;
  std::vector<std::size_t> place_;  ///< of a scan among the members
  double spacing_mm_ = 0;
  Vector3d about_mm_;
  double arm_mm_ = 0;
  std::vector<MotionMatrix> blocks_, held_;  ///< on the diagonal, without and with what holds motions small
  std::vector<Eigen::Triplet<double>> beside_;  ///< below the diagonal
  Eigen::VectorXd right_;
};

}  // namespace

std::vector<Misplacement> misplacements(std::span<const StitchSurface* const> scans,
                                        std::span<const PoseLink> links) {
  std::vector<Misplacement> out(scans.size());
  DisjointSets sets(scans.size());
  for (const PoseLink& link : links) {
    if (link.step.is_known()) {
      sets.unite(static_cast<std::uint32_t>(link.a), static_cast<std::uint32_t>(link.b));
    }
  }
  std::vector<std::vector<std::size_t>> members(scans.size());
  for (std::size_t k = 0; k < scans.size(); ++k) {
    members[sets.root(static_cast<std::uint32_t>(k))].push_back(k);
  }
  for (std::size_t first = 0; first < scans.size(); ++first) {
    if (members[first].size() < 2) {
      continue;
    }
    Group group(std::move(members[first]), scans);
    for (const PoseLink& link : links) {
      if (link.step.is_known() && sets.root(static_cast<std::uint32_t>(link.a)) == first) {
        group.add(link);
      }
    }
    group.write_misplacements(out);
  }
  return out;
}

}  // namespace dubsar
