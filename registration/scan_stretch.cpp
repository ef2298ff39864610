// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/scan_stretch.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "core/number_text.h"
#include "core/parallel.h"
#include "registration/nearest_usable.h"
#include "registration/twist.h"

namespace dubsar {

namespace {

/// Three of a turn, three of a shift, two of lengths, one of a shear.
using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;
constexpr Eigen::Index kShear = 8;

/// Right scans of the bunny and the dragon show up to 0.003 along either axis, simulated tablets up to
/// 0.0055.
constexpr double kLeastStretch = 0.008;
constexpr double kMostSigma = 0.0004;  ///< of what is too little shared to tell
/// Where they are held as well as this, simulated tablets show up to 0.0048, the dragon in its published
/// poses up to 0.0071, the bunny 0.0051.
constexpr double kLeastShear = 0.012;
constexpr double kMostShearSigma = 0.001;
constexpr double kMostStretch = 0.1;  ///< of any; beyond, the fit went astray

/// A step that changes them by less is the last.
constexpr double kSettled = 1e-4;

/// One sample in so many tells whether lengths may be off: where it says less than half of what is told, they
/// are not. Of 120 that were told it said 0.0018 less than all samples at most.
constexpr std::size_t kHintEvery = 4;
constexpr double kHintStretch = 0.5 * kLeastStretch;
constexpr double kHintShear = 0.5 * kLeastShear;
/// Samples whose partners are looked for together.
constexpr std::size_t kSamplesPerPart = 256;

/// A pose of the scan and a stretch of it about a centre in its own frame, along x and y, with a shear of y
/// into x. Depth goes with the mean of the two: left free it follows what rims do, 3 % on right scans, and
/// draws the others along.
struct Stretched {
  RigidTransform model_from_scanner;
  Eigen::Vector3d center_mm{0, 0, 0};
  Eigen::Vector2d stretch{0, 0};
  double shear = 0;

  [[nodiscard]] Eigen::Vector3d from_center(const Eigen::Vector3d& p_mm) const {
    const Eigen::Vector3d by(stretch.x(), stretch.y(), stretch.mean());
    const Eigen::Vector3d from_mm = p_mm - center_mm;
    return (Eigen::Vector3d::Ones() + by).cwiseProduct(from_mm) +
           shear * from_mm.y() * Eigen::Vector3d::UnitX();
  }
  /// The samples with stretch and shear taken off.
  [[nodiscard]] std::unique_ptr<SurfaceLevel> taken_off(const SurfaceLevel& level) const {
    auto out = std::make_unique<SurfaceLevel>();
    out->spacing_mm = level.spacing_mm;
    out->samples = level.samples;
    for (SurfaceSample& sample : out->samples) {
      sample.position_mm = (center_mm + from_center(sample.position_mm.cast<double>())).cast<float>();
    }
    return out;
  }
  [[nodiscard]] Eigen::Vector3d operator()(const Eigen::Vector3d& p_mm) const {
    return model_from_scanner * (center_mm + from_center(p_mm));
  }
};

struct Normals {
  Matrix9d h = Matrix9d::Zero();
  Vector9d g = Vector9d::Zero();
  double weight = 0, radius2 = 0;
};

/// One sample in `every` and its partners in all targets.
Normals normals_at(const Stretched& at, const SurfaceLevel& source, std::span<const IcpTarget> targets,
                   double reach_mm, double kernel_mm, std::size_t every) {
  const Eigen::Vector3d center = at.model_from_scanner * at.center_mm;
  std::vector<RigidTransform> target_from_model;
  target_from_model.reserve(targets.size());
  for (const IcpTarget& target : targets) {
    target_from_model.push_back(target.model_from_scanner.inverse());
  }
  return parallel_reduce_ordered(
      source.samples.size(), kSamplesPerPart, Normals{},
      [&](std::size_t begin, std::size_t end) {
        const std::size_t count = (end - begin + every - 1) / every;
        std::vector<Eigen::Vector3d> moved(count);
        std::vector<Eigen::Vector3f> asked(count);
        std::vector<GridLookup::Found> found(count * targets.size());
        for (std::size_t i = 0; i < count; ++i) {
          moved[i] = at(source.samples[begin + i * every].position_mm.cast<double>());
        }
        for (std::size_t t = 0; t < targets.size(); ++t) {
          for (std::size_t i = 0; i < count; ++i) {
            asked[i] = (target_from_model[t] * moved[i]).cast<float>();
          }
          nearest_usable(*targets[t].level, asked, static_cast<float>(reach_mm),
                         std::span(found).subspan(t * count, count));
        }
        Normals out;
        for (std::size_t i = 0; i < count; ++i) {
          const SurfaceSample& sample = source.samples[begin + i * every];
          const Eigen::Vector3d own = sample.position_mm.cast<double>();
          const Eigen::Vector3d& p = moved[i];
          const Eigen::Vector3d n_from = at.model_from_scanner.rotation * sample.normal.cast<double>();
          for (std::size_t t = 0; t < targets.size(); ++t) {
            const IcpTarget& target = targets[t];
            const auto& [partner, partner_mm] = found[t * count + i];
            if (partner < 0) {
              continue;
            }
            const auto j = static_cast<std::size_t>(partner);
            const Eigen::Vector3d n_into =
                target.model_from_scanner.rotation * target.level->normals[j].cast<double>();
            if (n_from.dot(n_into) < 0.7) {
              continue;
            }
            const Eigen::Vector3d n = (n_from + n_into).normalized();
            const Eigen::Vector3d there =
                target.model_from_scanner * Eigen::Vector3d(partner_mm.cast<double>());
            const double residual = n.dot(p - there);
            const double w = static_cast<double>(sample.weight) * tukey_weight(residual, kernel_mm);
            if (w <= 0) {
              continue;
            }
            const Eigen::Vector3d arm = p - center;
            const Eigen::Vector3d from_mm = own - at.center_mm;
            const Eigen::Vector3d n_own = at.model_from_scanner.rotation.transpose() * n;
            const Eigen::Vector3d by_axis = n_own.cwiseProduct(from_mm);
            Vector9d jacobian;
            jacobian << arm.cross(n), n, by_axis.x() + 0.5 * by_axis.z(), by_axis.y() + 0.5 * by_axis.z(),
                n_own.x() * from_mm.y();
            out.h.noalias() += w * jacobian * jacobian.transpose();
            out.g += w * residual * jacobian;
            out.weight += w;
            out.radius2 += w * arm.squaredNorm();
          }
        }
        return out;
      },
      [](Normals& into, const Normals& part) {
        into.h += part.h;
        into.g += part.g;
        into.weight += part.weight;
        into.radius2 += part.radius2;
      });
}

/// What a fit with free lengths, and a shear that is free or none, came to.
struct FreeFit {
  Stretched at;
  double sigma = 0, shear_sigma = 0;
};

enum class Shear { kNone, kFree };

/// Of one sample in `every`. Nothing where too little is shared.
std::optional<FreeFit> fit_freely(const ScanSurface& scan, std::span<const ModelScan> model,
                                  const ModelFit& fit, Shear shear, std::size_t every) {
  FreeFit out{{fit.model_from_scanner, scan.centroid_mm}};
  Stretched& at = out.at;
  for (const double sigmas : {12.0, 6.0, 3.0}) {
    const bool wide = sigmas == 12.0;
    const SurfaceLevel& level = wide ? *scan.medium : *scan.fine;
    const std::vector<IcpTarget> targets =
        targets_of(model, fit.targets, wide ? &ScanSurface::medium : &ScanSurface::fine);
    const double kernel_mm = std::max(sigmas * fit.residual_sigma_mm, wide ? 0.2 * level.spacing_mm : 0.0);
    const double reach_mm = std::max(2.0 * level.spacing_mm, 5.0 * kernel_mm);
    for (int step = 0; step < 6; ++step) {
      Normals sums = normals_at(at, level, targets, reach_mm, kernel_mm, every);
      if (!(sums.weight > 0)) {
        return std::nullopt;
      }
      const double radius2 = sums.radius2 / sums.weight;
      const double hold = 1e-3 * sums.weight;
      sums.h.diagonal().head<3>().array() += hold * radius2;
      sums.h.diagonal().segment<3>(3).array() += hold;
      sums.h.diagonal().tail<3>().array() += hold * radius2;
      if (shear == Shear::kNone) {
        sums.h.row(kShear).setZero();
        sums.h.col(kShear).setZero();
        sums.h(kShear, kShear) = sums.weight;
        sums.g[kShear] = 0;
      }
      const Vector9d move = sums.h.ldlt().solve(-sums.g);
      if (!move.allFinite()) {
        return std::nullopt;
      }
      at.model_from_scanner =
          twisted(at.model_from_scanner, move.head<6>(), at.model_from_scanner * at.center_mm);
      at.stretch += move.segment<2>(6);
      at.shear += move[kShear];
      const Vector9d variances = sums.h.inverse().diagonal();
      out.sigma = fit.residual_sigma_mm * std::sqrt(std::max(variances[6], variances[7]));
      out.shear_sigma = fit.residual_sigma_mm * std::sqrt(variances[kShear]);
      if (move.tail<3>().cwiseAbs().maxCoeff() < kSettled) {
        break;
      }
    }
  }
  return out;
}

std::string percent_of(double share) {
  return fixed_text(100.0 * std::abs(share), 1) + " %";
}

double larger_of(const Eigen::Vector2d& stretch) {
  return stretch.cwiseAbs().maxCoeff();
}

std::optional<ScanStretch> stretch_of(const ScanSurface& scan, const std::optional<FreeFit>& free) {
  if (!free) {
    return std::nullopt;
  }
  const Stretched& at = free->at;
  auto mended = std::make_unique<ScanSurface>();
  mended->fine = at.taken_off(*scan.fine);
  mended->medium = at.taken_off(*scan.medium);
  mended->noise_mm = scan.noise_mm;
  mended->scale_mm = scan.scale_mm;
  // What would make it fit is the opposite of what is wrong with it.
  return ScanStretch{-at.stretch.x(),   -at.stretch.y(),      -at.shear, free->sigma, free->shear_sigma,
                     std::move(mended), at.model_from_scanner};
}

}  // namespace

bool may_be_stretched(const ScanSurface& scan, std::span<const ModelScan> model, const ModelFit& fit) {
  const std::optional<FreeFit> some = fit_freely(scan, model, fit, Shear::kFree, kHintEvery);
  return !some || !(larger_of(some->at.stretch) < kHintStretch) || !(std::abs(some->at.shear) < kHintShear);
}

std::optional<ScanStretch> find_stretch(const ScanSurface& scan, std::span<const ModelScan> model,
                                        const ModelFit& fit) {
  std::optional<ScanStretch> sheared = stretch_of(scan, fit_freely(scan, model, fit, Shear::kFree, 1));
  if (sheared && sheared->is_sheared()) {
    return sheared;
  }
  // What is free and not wrong takes up a little of what is.
  std::optional<ScanStretch> stretched = stretch_of(scan, fit_freely(scan, model, fit, Shear::kNone, 1));
  if (stretched) {
    stretched->shear_sigma = sheared ? sheared->shear_sigma : std::numeric_limits<double>::infinity();
  }
  return stretched;
}

bool ScanStretch::has_lengths_off() const {
  const double larger = larger_of({along_line, along_motion});
  return larger >= kLeastStretch && larger <= kMostStretch && sigma <= kMostSigma;
}

bool ScanStretch::acquits_of(const ScanStretch& accused) const {
  return !is_off() && (!accused.has_lengths_off() || sigma <= kMostSigma) &&
         (!accused.is_sheared() || shear_sigma <= kMostShearSigma);
}

bool ScanStretch::is_sheared() const {
  return std::abs(shear) >= kLeastShear && std::abs(shear) <= kMostStretch && shear_sigma <= kMostShearSigma;
}

bool ScanStretch::is_rather_sheared() const {
  return is_sheared() && (!has_lengths_off() || std::abs(shear) > larger_of({along_line, along_motion}));
}

double ScanStretch::largest() const {
  return is_rather_sheared() ? std::abs(shear) : larger_of({along_line, along_motion});
}

std::string reason_of(const ScanStretch& stretch) {
  if (stretch.is_rather_sheared()) {
    return "against the other scans it is sheared sideways by " + percent_of(stretch.shear) +
           " of its motion: it drifted while it was scanned, or the stage does not run square to the laser "
           "line; verify the scanner, then scan it again";
  }
  const auto told = [&](double by, const char* larger, const char* smaller) {
    return "against the other scans it is " + percent_of(by) + (by > 0 ? larger : smaller) +
           "; verify the scanner, then scan it again";
  };
  if (std::abs(stretch.along_line - stretch.along_motion) < kLeastStretch) {
    return told(0.5 * (stretch.along_line + stretch.along_motion),
                " too large: its calibration is not theirs", " too small: its calibration is not theirs");
  }
  if (std::abs(stretch.along_motion) > std::abs(stretch.along_line)) {
    return told(stretch.along_motion,
                " too long along the motion: the step of the stage, or the calibration, is off",
                " too short along the motion: the step of the stage, or the calibration, is off");
  }
  return told(stretch.along_line, " too long along the laser line: the calibration is off",
              " too short along the laser line: the calibration is off");
}

}  // namespace dubsar
