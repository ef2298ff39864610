// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Chen and Medioni 1992 (point-to-plane); Turk and Levoy 1994 (weights, no boundary pairs); Rusinkiewicz, A
// symmetric objective function for ICP, ACM TOG 38 (2019).
#include "registration/icp.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/parallel.h"
#include "registration/absolute_orientation.h"
#include "registration/icp_information.h"
#include "registration/nearest_usable.h"
#include "registration/twist.h"

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

/// The slope of the pull is measured over moves of so many spacings …
constexpr double kSlopeStepSpacings = 0.5;
/// … on each so-manieth sample.
constexpr std::size_t kSlopeEvery = 4;
/// Steps that are taken with it.
constexpr int kLastSteps = 2;
/// Samples whose pairs are looked for together.
constexpr std::size_t kSamplesPerPart = 512;

/// Pairs each sample of `from` with the nearest usable sample of `into`. `moving_is_from` tells which side
/// the perturbation acts on. Both frames are given in the model frame.
void accumulate(const SurfaceLevel& from, const RigidTransform& model_from_from, const SurfaceLevel& into,
                const RigidTransform& model_from_into, bool moving_is_from, const Eigen::Vector3d& center_mm,
                const IcpOptions& options, std::size_t every, Sums& total, std::vector<PullTerm>* terms) {
  std::size_t first_term = 0;
  if (terms != nullptr) {
    first_term = terms->size();
    terms->resize(first_term + from.samples.size());
  }
  const RigidTransform into_from_from = model_from_into.inverse() * model_from_from;
  const Eigen::Matrix3f rotation = into_from_from.rotation.cast<float>();
  const Eigen::Vector3f shift = into_from_from.translation_mm.cast<float>();
  const auto reach = static_cast<float>(options.reach_mm);
  const auto least_cosine = static_cast<float>(options.normal_cosine);
  total.add(parallel_reduce_ordered(
      from.samples.size(), kSamplesPerPart, Sums{},
      [&](std::size_t begin, std::size_t end) {
        Sums sums;
        std::array<Eigen::Vector3f, kSamplesPerPart> points;
        std::array<GridLookup::Found, kSamplesPerPart> found;
        const std::size_t count = (end - begin + every - 1) / every;
        for (std::size_t i = 0; i < count; ++i) {
          points[i] = rotation * from.samples[begin + i * every].position_mm + shift;
        }
        nearest_usable(into, {points.data(), count}, reach, {found.data(), count});
        for (std::size_t i = 0; i < count; ++i) {
          const auto& [j, q] = found[i];
          if (j < 0 || (options.within_borders && !lies_on(into, found[i], points[i]))) {
            continue;
          }
          const std::size_t k = begin + i * every;
          const SurfaceSample& sample = from.samples[k];
          const Eigen::Vector3f& p = points[i];
          const Eigen::Vector3f n_from = rotation * sample.normal;
          const Eigen::Vector3f& n_into = into.normals[static_cast<std::size_t>(j)];
          if (n_from.dot(n_into) < least_cosine) {
            continue;
          }
          const Eigen::Vector3f n = (n_from + n_into).normalized();
          const double residual = static_cast<double>(n.dot(p - q));
          const double w = static_cast<double>(sample.weight) * tukey_weight(residual, options.kernel_mm);
          if (w <= 0) {
            continue;
          }
          const Eigen::Vector3d normal = model_from_into.rotation * n.cast<double>();
          const Eigen::Vector3d arm =
              model_from_into * Eigen::Vector3d((moving_is_from ? p : q).cast<double>()) - center_mm;
          Vector6d jacobian;
          jacobian << arm.cross(normal), normal;
          if (!moving_is_from) {
            jacobian = -jacobian;
          }
          sums.h.noalias() += w * jacobian * jacobian.transpose();
          sums.g += w * residual * jacobian;
          if (terms != nullptr) {
            (*terms)[first_term + k] = {w * residual * jacobian, arm, normal, sample.crease, true};
          }
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
        const std::int64_t found =
            nearest_usable(into, rotation * sample.position_mm + shift, static_cast<float>(options.reach_mm));
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
    const double w = static_cast<double>(sample.weight) * tukey_weight((p - q).norm(), options.kernel_mm);
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
    const std::optional<RigidTransform> step = absolute_orientation(pairs.moved, pairs.still, pairs.weights);
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

/// What the pairs pull at a pose of the source, every one or one in `every`; their terms, too, where asked
/// for.
struct Pull {
  const SurfaceLevel& source;
  std::span<const IcpTarget> targets;
  const IcpOptions& options;

  [[nodiscard]] Sums at(const RigidTransform& pose, const Eigen::Vector3d& center_mm, std::size_t every = 1,
                        std::vector<PullTerm>* terms = nullptr) const {
    Sums sums;
    for (const IcpTarget& target : targets) {
      accumulate(source, pose, *target.level, target.model_from_scanner, true, center_mm, options, every,
                 sums, terms);
      if (options.two_way) {
        accumulate(*target.level, target.model_from_scanner, source, pose, false, center_mm, options, every,
                   sums, terms);
      }
    }
    return sums;
  }
};

/// The root of the mean square distance of the pairs from the centre.
double radius_of(const Sums& sums) {
  return std::max(1e-9, std::sqrt(sums.radius2 / sums.weight));
}

/// Point-to-plane steps from out's pose until it moves no more; the sums at the last pose.
Sums point_to_plane(const Pull& pull, const Eigen::Vector3d& middle, int steps, IcpResult& out) {
  const auto evaluate = [&] {
    out.center_mm = out.model_from_source * middle;
    return pull.at(out.model_from_source, out.center_mm);
  };
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
    out.model_from_source = twisted(out.model_from_source, step, out.center_mm);
    sums = evaluate();
    if (step.head<3>().norm() * std::sqrt(radius2) + step.tail<3>().norm() < pull.options.converged_mm) {
      out.converged = true;
      break;
    }
  }
  return sums;
}

/// The slope of the pull, measured: the scan is moved and its pairs are made anew. The normal matrix takes
/// every partner for fixed, and so counts the noise of the normals as slopes of the surface that hold the
/// scan; and the nearest of noisy samples lies too near, so that the pull is too weak.
Matrix6d measured_slope(const Pull& pull, const RigidTransform& pose, const Eigen::Vector3d& center_mm,
                        double radius, double h_mm) {
  Matrix6d slope;
  for (int k = 0; k < 6; ++k) {
    const double h = k < 3 ? h_mm / radius : h_mm;
    const Vector6d step = h * Vector6d::Unit(k);
    const Sums ahead = pull.at(twisted(pose, step, center_mm), center_mm, kSlopeEvery);
    const Sums behind = pull.at(twisted(pose, -step, center_mm), center_mm, kSlopeEvery);
    slope.col(k) = static_cast<double>(kSlopeEvery) * (ahead.g - behind.g) / (2.0 * h);
  }
  return slope;
}

/// The information of the fit, from the measured slope; the last steps are taken with that, too, when
/// `may_step`: along weak directions the normal matrix makes them too short. Returns the sums at the last
/// pose.
Sums inform(const Pull& pull, Sums sums, bool may_step, IcpResult& out) {
  const double radius = radius_of(sums);
  const double h_mm = kSlopeStepSpacings * pull.source.spacing_mm;
  const Matrix6d slope = measured_slope(pull, out.model_from_source, out.center_mm, radius, h_mm);
  std::vector<PullTerm> terms;
  for (int k = 0; k < (may_step ? kLastSteps : 0); ++k) {
    const Vector6d step = held_step(slope, sums.g, sums.weight, radius, h_mm);
    out.model_from_source = twisted(out.model_from_source, step, out.center_mm);
    terms.clear();
    sums = pull.at(out.model_from_source, out.center_mm, 1, &terms);
  }
  if (!may_step) {
    sums = pull.at(out.model_from_source, out.center_mm, 1, &terms);
  }
  const FitInformation found = fit_information(slope, terms, {radius, pull.source.spacing_mm});
  out.information = found.information;
  out.blocks = found.blocks;
  if (pull.targets.size() == 1 && pull.options.two_way) {
    const std::size_t sent = pull.source.samples.size();
    out.on_source = footprint(pull.source.samples, std::span(terms).first(sent));
    out.on_target = footprint(pull.targets.front().level->samples, std::span(terms).subspan(sent));
  }
  return sums;
}

/// How firmly the pairs hold the scan in the direction in which they hold it least, and which that is.
void judge_stability(const Sums& sums, IcpResult& out) {
  Vector6d scale;
  scale << Eigen::Vector3d::Constant(1.0 / radius_of(sums)), Eigen::Vector3d::Ones();
  const Matrix6d scaled = scale.asDiagonal() * sums.h * scale.asDiagonal() / sums.weight;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scaled);
  out.stability = std::max(0.0, eigen.eigenvalues()[0]);
  out.weakest = eigen.eigenvectors().col(0);
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
  int steps = options.iterations;
  if (options.metric == IcpMetric::kPointToPoint) {
    out.converged = point_to_point(source, targets, middle, options, out.model_from_source);
    steps = 0;
  }
  const Pull pull{source, targets, options};
  Sums sums = point_to_plane(pull, middle, steps, out);
  if (options.information && sums.pairs >= 6 && sums.weight > 0) {
    sums = inform(pull, std::move(sums), steps > 0, out);
  }
  out.pairs = sums.pairs;
  out.weight = sums.weight;
  out.normal_matrix = sums.h;
  if (sums.pairs >= 6 && sums.weight > 0) {
    out.rms_mm = std::sqrt(sums.residual2 / sums.weight);
    judge_stability(sums, out);
  }
  return out;
}

}  // namespace dubsar
