// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Chen and Medioni 1992 (point-to-plane); Turk and Levoy 1994 (weights, no boundary pairs); Rusinkiewicz, A
// symmetric objective function for ICP, ACM TOG 38 (2019).
#include "registration/icp.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <optional>

#include "core/parallel.h"
#include "registration/absolute_orientation.h"

namespace dubsar {

namespace {

struct Sums {
  Matrix6d h = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double weight = 0;
  double residual2 = 0;
  double radius2 = 0;
  int pairs = 0;

  void add(const Sums& b) {
    h += b.h;
    g += b.g;
    weight += b.weight;
    residual2 += b.residual2;
    radius2 += b.radius2;
    pairs += b.pairs;
  }
};

/// Tukey's weight; pairs far off say nothing.
double robust_weight(double residual, double scale) {
  const double u = residual / (4.685 * scale);
  const double v = 1.0 - u * u;
  return v > 0 ? v * v : 0.0;
}

/// How far beyond a boundary sample the usable ones begin, in raster cells.
constexpr float kRimCells = 2.0F;

/// The usable sample of `level` nearest to p within reach_mm, or -1. What the camera saw straight at p bounds
/// the search, so that it seldom looks farther than the next cell; where nothing was seen, only the next
/// cells are searched: the nearest sample would be one of the border.
std::int64_t nearest_usable(const SurfaceLevel& level, const Eigen::Vector3f& p, float reach_mm) {
  const DepthRaster::Cell* cell = level.raster.at(p);
  const auto cell_mm = static_cast<float>(level.raster.cell_mm());
  float radius_mm = std::min(reach_mm, cell_mm);
  if (cell != nullptr && cell->sample >= 0) {
    const auto straight = static_cast<std::size_t>(cell->sample);
    if (std::abs(level.raster.height(p) - cell->height_mm) > 2.0F * reach_mm) {
      return -1;
    }
    const float d = 1.0001F * (level.grid.point(straight) - p).norm();
    radius_mm = std::min(reach_mm, level.usable[straight] != 0 ? d : d + kRimCells * cell_mm);
  }
  return level.lookup->nearest(p, radius_mm);
}

/// Pairs each sample of `from` with the nearest usable sample of `into`. `moving_is_from` tells which side
/// the perturbation acts on. Both frames are given in the model frame.
void accumulate(const SurfaceLevel& from, const RigidTransform& model_from_from, const SurfaceLevel& into,
                const RigidTransform& model_from_into, bool moving_is_from, const Eigen::Vector3d& center_mm,
                const IcpOptions& options, Sums& total) {
  const RigidTransform into_from_from = model_from_into.inverse() * model_from_from;
  const Eigen::Matrix3f rotation = into_from_from.rotation.cast<float>();
  const Eigen::Vector3f shift = into_from_from.translation_mm.cast<float>();
  const auto reach = static_cast<float>(options.reach_mm);
  const auto least_cosine = static_cast<float>(options.normal_cosine);
  total.add(parallel_reduce_ordered(
      from.samples.size(), 512, Sums{},
      [&](std::size_t begin, std::size_t end) {
        Sums sums;
        for (std::size_t k = begin; k < end; ++k) {
          const SurfaceSample& sample = from.samples[k];
          const Eigen::Vector3f p = rotation * sample.position_mm + shift;
          const std::int64_t found = nearest_usable(into, p, reach);
          if (found < 0) {
            continue;
          }
          const auto j = static_cast<std::size_t>(found);
          const Eigen::Vector3f n_from = rotation * sample.normal;
          const Eigen::Vector3f& n_into = into.normals[j];
          if (n_from.dot(n_into) < least_cosine) {
            continue;
          }
          const Eigen::Vector3f n = (n_from + n_into).normalized();
          const double residual = static_cast<double>(n.dot(p - into.grid.point(j)));
          const double w = static_cast<double>(sample.weight) * robust_weight(residual, options.kernel_mm);
          if (w <= 0) {
            continue;
          }
          const Eigen::Vector3d normal = model_from_into.rotation * n.cast<double>();
          const Eigen::Vector3d arm =
              model_from_into * Eigen::Vector3d((moving_is_from ? p : into.grid.point(j)).cast<double>()) -
              center_mm;
          Vector6d jacobian;
          jacobian << arm.cross(normal), normal;
          if (!moving_is_from) {
            jacobian = -jacobian;
          }
          sums.h.noalias() += w * jacobian * jacobian.transpose();
          sums.g += w * residual * jacobian;
          sums.weight += w;
          sums.residual2 += w * residual * residual;
          sums.radius2 += w * arm.squaredNorm();
          ++sums.pairs;
        }
        return sums;
      },
      [](Sums& into_sum, const Sums& part) { into_sum.add(part); }));
}

/// Pairs of points in the model frame with their weights, the moved scan's first.
struct PointPairs {
  std::vector<Eigen::Vector3d> moved, still;
  std::vector<double> weights;
};

/// The samples of `from` with their nearest neighbours in `into`, as accumulate() pairs them, but the Tukey
/// weight is that of the distance.
void collect(const SurfaceLevel& from, const RigidTransform& model_from_from, const SurfaceLevel& into,
             const RigidTransform& model_from_into, bool moving_is_from, const IcpOptions& options,
             PointPairs& pairs) {
  const RigidTransform into_from_from = model_from_into.inverse() * model_from_from;
  const Eigen::Matrix3f rotation = into_from_from.rotation.cast<float>();
  const Eigen::Vector3f shift = into_from_from.translation_mm.cast<float>();
  std::vector<std::int64_t> partner(from.samples.size(), -1);
  parallel_for_each_index(
      partner.size(),
      [&](std::size_t k) {
        const SurfaceSample& sample = from.samples[k];
        const std::int64_t found = nearest_usable(into, rotation * sample.position_mm + shift,
                                                  static_cast<float>(options.reach_mm));
        if (found >= 0 && (rotation * sample.normal).dot(into.normals[static_cast<std::size_t>(found)]) >=
                              static_cast<float>(options.normal_cosine)) {
          partner[k] = found;
        }
      },
      512);
  for (std::size_t k = 0; k < partner.size(); ++k) {
    if (partner[k] < 0) {
      continue;
    }
    const SurfaceSample& sample = from.samples[k];
    const Eigen::Vector3d p = model_from_from * Eigen::Vector3d(sample.position_mm.cast<double>());
    const Eigen::Vector3d q =
        model_from_into *
        Eigen::Vector3d(into.grid.point(static_cast<std::size_t>(partner[k])).cast<double>());
    const double w =
        static_cast<double>(sample.weight) * robust_weight((p - q).norm(), options.kernel_mm);
    if (w > 0) {
      pairs.moved.push_back(moving_is_from ? p : q);
      pairs.still.push_back(moving_is_from ? q : p);
      pairs.weights.push_back(w);
    }
  }
}

/// Steps in closed form. True when it converged.
bool point_to_point(const SurfaceLevel& source, std::span<const IcpTarget> targets,
                    const Eigen::Vector3d& middle, const IcpOptions& options, RigidTransform& pose) {
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    PointPairs pairs;
    for (const IcpTarget& target : targets) {
      collect(source, pose, *target.level, target.model_from_scanner, true, options, pairs);
      if (options.two_way) {
        collect(*target.level, target.model_from_scanner, source, pose, false, options, pairs);
      }
    }
    const std::optional<RigidTransform> step =
        absolute_orientation(pairs.moved, pairs.still, pairs.weights);
    if (!step) {
      return false;
    }
    const Eigen::Vector3d center = pose * middle;
    double radius2 = 0;
    for (const Eigen::Vector3d& p : pairs.moved) {
      radius2 += (p - center).squaredNorm() / static_cast<double>(pairs.moved.size());
    }
    pose = (*step * pose).orthonormalised();
    if (step->angle_rad() * std::sqrt(radius2) + (*step * center - center).norm() < options.converged_mm) {
      return true;
    }
  }
  return false;
}

}  // namespace

IcpResult icp(const SurfaceLevel& source, std::span<const IcpTarget> targets,
              const RigidTransform& model_from_source, const IcpOptions& options) {
  IcpResult out;
  out.model_from_source = model_from_source;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const SurfaceSample& sample : source.samples) {
    middle += sample.position_mm.cast<double>();
  }
  middle /= std::max<double>(1.0, static_cast<double>(source.samples.size()));
  const auto evaluate = [&] {
    Sums sums;
    out.center_mm = out.model_from_source * middle;
    for (const IcpTarget& target : targets) {
      accumulate(source, out.model_from_source, *target.level, target.model_from_scanner, true, out.center_mm,
                 options, sums);
      if (options.two_way) {
        accumulate(*target.level, target.model_from_scanner, source, out.model_from_source, false,
                   out.center_mm, options, sums);
      }
    }
    return sums;
  };
  int steps = options.iterations;
  if (options.metric == IcpMetric::kPointToPoint) {
    out.converged = point_to_point(source, targets, middle, options, out.model_from_source);
    steps = 0;
  }
  Sums sums = evaluate();
  for (int iteration = 0; iteration < steps && sums.pairs >= 6; ++iteration) {
    const double radius2 = sums.radius2 / sums.weight;
    Matrix6d damped = sums.h;
    // A thousandth of the mean strength: enough to hold what nothing else holds, too little to slow the rest.
    const double hold = 1e-3 * sums.weight;
    damped.topLeftCorner<3, 3>().diagonal().array() += hold * radius2;
    damped.bottomRightCorner<3, 3>().diagonal().array() += hold;
    const Vector6d step = damped.ldlt().solve(-sums.g);
    if (!step.allFinite()) {
      break;
    }
    const RigidTransform turn = RigidTransform::from_twist(step.head<3>(), Eigen::Vector3d::Zero());
    RigidTransform& pose = out.model_from_source;
    pose.rotation = turn.rotation * pose.rotation;
    pose.translation_mm =
        turn.rotation * (pose.translation_mm - out.center_mm) + out.center_mm + step.tail<3>();
    pose = pose.orthonormalised();
    sums = evaluate();
    if (step.head<3>().norm() * std::sqrt(radius2) + step.tail<3>().norm() < options.converged_mm) {
      out.converged = true;
      break;
    }
  }
  out.pairs = sums.pairs;
  out.weight = sums.weight;
  out.normal_matrix = sums.h;
  if (sums.pairs >= 6 && sums.weight > 0) {
    out.rms_mm = std::sqrt(sums.residual2 / sums.weight);
    const double radius = std::max(1e-9, std::sqrt(sums.radius2 / sums.weight));
    Vector6d scale;
    scale << Eigen::Vector3d::Constant(1.0 / radius), Eigen::Vector3d::Ones();
    const Matrix6d scaled = scale.asDiagonal() * sums.h * scale.asDiagonal() / sums.weight;
    const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scaled);
    out.stability = std::max(0.0, eigen.eigenvalues()[0]);
    out.weakest = eigen.eigenvectors().col(0);
  }
  return out;
}

}  // namespace dubsar
