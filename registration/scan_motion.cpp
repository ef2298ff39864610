// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/scan_motion.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/parallel.h"

namespace dubsar {

namespace {

// Measured with slips of 0.3 to 4 mm in simulated tablets and with the bunny and the dragon: bands of right
// scans stay within one spacing or gain less than 0.03; bands that slipped gain 0.15 to 0.98.
constexpr std::size_t kBands = 6;
constexpr std::size_t kLeastSamples = 120;  ///< of a band, on what the others saw
constexpr int kLeastClose = 200;            ///< counted over all scans that it is fitted to
constexpr double kLeastStability = 0.002;   ///< see IcpResult; below, a band slides by itself
// Bands of right scans agree no better anywhere, and a part of their samples shows it: where at least so much
// agrees as the scan lies, and that part gains or loses less than so much where it fits by itself. Of 312
// bands that were found slipped, by 1.2 to 12 spacings, none gained less than 0.107 there but for one of
// which nothing agreed.
constexpr double kHintAgrees = 0.5;
constexpr double kHintOfGain = 0.03;
constexpr int kMostSkipped = 8;  ///< one sample in so many says that, where enough are left to tell by

/// What makes a slip of what the bands say.
struct Limits {
  double least_spacings;  ///< a smaller shift is what any fit of a part leaves
  double agrees;          ///< of the samples, where a band lies right
  double least_gain;      ///< in agreement
};
constexpr Limits kLimits{1.5, 0.85, 0.12};
/// Of a scan that was found to have slipped: so far below that the micrometres by which poses change with
/// each other scan do not turn the verdict to and fro (2 µm changed shifts by up to 0.07 spacings, agreement
/// by up to 0.03), and above what right scans show.
constexpr Limits kLimitsAgain{1.25, 0.8, 0.08};

// How far a band is looked for, in parts of the scale.
constexpr double kReaches[] = {0.06, 0.02};

/// The samples of some rows, at one level.
SurfaceLevel rows_of(const SurfaceLevel& level, float from, float to) {
  SurfaceLevel out;
  out.spacing_mm = level.spacing_mm;
  std::copy_if(level.samples.begin(), level.samples.end(), std::back_inserter(out.samples),
               [&](const SurfaceSample& s) { return s.row >= from && s.row < to; });
  return out;
}

/// One sample in `every`.
SurfaceLevel thinned(const SurfaceLevel& level, int every) {
  SurfaceLevel out;
  out.spacing_mm = level.spacing_mm;
  for (std::size_t k = 0; k < level.samples.size(); k += static_cast<std::size_t>(every)) {
    out.samples.push_back(level.samples[k]);
  }
  return out;
}

/// The scan among those that it overlaps.
struct Fitted {
  const ScanSurface& scan;
  std::span<const ModelScan> model;
  const ModelFit& fit;
  const ModelFitOptions& options;
  const Limits& limits;

  [[nodiscard]] PoseEvidence evidence(const SurfaceLevel& part, const RigidTransform& pose) const {
    return evidence_of_part(part, scan, model, fit.targets, pose, options);
  }

  [[nodiscard]] bool seen_by_others(const SurfaceSample& sample) const {
    return std::any_of(fit.targets.begin(), fit.targets.end(), [&](std::size_t k) {
      const RigidTransform from_scan = model[k].model_from_scanner.inverse() * fit.model_from_scanner;
      const Eigen::Vector3f p =
          (from_scan * Eigen::Vector3d(sample.position_mm.cast<double>())).cast<float>();
      const DepthRaster& raster = model[k].surface->fine->raster;
      const DepthRaster::Cell* cell = raster.at(p);
      return cell != nullptr && cell->sample >= 0 &&
             std::abs(raster.height(p) - raster.height(*cell)) <
                 static_cast<float>(options.band * scan.scale_mm);
    });
  }

  /// Where a band fits by itself to within the fine level's reach, from where the scan lies.
  [[nodiscard]] RigidTransform near_fit(const SurfaceLevel& medium) const {
    IcpOptions step;
    step.normal_cosine = 0.6;
    step.iterations = 10;
    step.converged_mm = 2e-4 * scan.scale_mm;
    const std::vector<IcpTarget> targets = targets_of(model, fit.targets, &ScanSurface::medium);
    RigidTransform pose = fit.model_from_scanner;
    for (const double reach : kReaches) {
      step.reach_mm = std::max(reach * scan.scale_mm, 2.0 * medium.spacing_mm);
      step.kernel_mm = std::max(0.12 * reach * scan.scale_mm, 0.2 * medium.spacing_mm);
      pose = icp(medium, targets, pose, step).model_from_source;
    }
    return pose;
  }

  /// Where it fits from there.
  [[nodiscard]] IcpResult fine_fit(const SurfaceLevel& fine, const RigidTransform& start) const {
    return refine_fine(fine, targets_of(model, fit.targets, &ScanSurface::fine), start,
                       fit.residual_sigma_mm);
  }

  /// How much better these samples agree where they then lie than where the scan has them.
  [[nodiscard]] double gain(const SurfaceLevel& some, const RigidTransform& start) const {
    return evidence(some, fine_fit(some, start).model_from_source).agreement() -
           evidence(some, fit.model_from_scanner).agreement();
  }
};

struct Band {
  float from = 0, to = 0;
  Eigen::Vector3d middle_mm = Eigen::Vector3d::Zero();  ///< where the scan puts it, model frame
  bool settled = false;                                 ///< it agrees, as the scan lies or moved
  RigidTransform motion;  ///< of the model frame, that takes it to where it agrees
  int gained = 0;         ///< samples by that
};

/// Where to begin the fit of a band that may have moved; nothing where it agrees as the scan lies, or a part
/// of it shows that it would elsewhere, too. `here`: the evidence of the band as the scan lies.
std::optional<RigidTransform> start_of(const Fitted& fitted, const Band& band, const SurfaceLevel& fine,
                                       const PoseEvidence& here) {
  if (here.agreement() > 1.0 - fitted.limits.least_gain || here.close + here.apart < kLeastClose) {
    return std::nullopt;  // nothing to gain, or too little to tell by
  }
  const RigidTransform start = fitted.near_fit(rows_of(*fitted.scan.medium, band.from, band.to));
  if (here.agreement() >= kHintAgrees) {
    const int every = std::min((here.close + here.apart) / kLeastClose, kMostSkipped);
    if (std::abs(fitted.gain(thinned(fine, every), start)) < kHintOfGain) {
      return std::nullopt;
    }
  }
  return start;
}

void look_at(const Fitted& fitted, Band& band) {
  const SurfaceLevel fine = rows_of(*fitted.scan.fine, band.from, band.to);
  const RigidTransform& pose = fitted.fit.model_from_scanner;
  for (const SurfaceSample& s : fine.samples) {
    band.middle_mm += pose * Eigen::Vector3d(s.position_mm.cast<double>());
  }
  band.middle_mm /= std::max<double>(1.0, static_cast<double>(fine.samples.size()));
  const PoseEvidence here = fitted.evidence(fine, pose);
  band.settled = here.close >= kLeastClose && here.agreement() >= fitted.limits.agrees;
  const std::optional<RigidTransform> start = start_of(fitted, band, fine, here);
  if (!start) {
    return;
  }
  const IcpResult there = fitted.fine_fit(fine, *start);
  const PoseEvidence moved = fitted.evidence(fine, there.model_from_source);
  if (there.stability >= kLeastStability && moved.close >= std::max(kLeastClose, here.close) &&
      moved.agreement() >= fitted.limits.agrees &&
      moved.agreement() - here.agreement() >= fitted.limits.least_gain) {
    band.settled = true;
    band.motion = there.model_from_source * pose.inverse();
    band.gained = moved.close - here.close;
  }
}

/// As many bands of rows, each with as much of what the others saw, as there is enough for.
std::vector<Band> bands_of(const Fitted& fitted) {
  std::vector<float> rows;
  for (const SurfaceSample& sample : fitted.scan.fine->samples) {
    if (fitted.seen_by_others(sample)) {
      rows.push_back(sample.row);
    }
  }
  std::sort(rows.begin(), rows.end());
  const std::size_t count = std::min(kBands, rows.size() / kLeastSamples);
  std::vector<Band> bands(count);
  for (std::size_t b = 0; b < count; ++b) {
    bands[b].from = b == 0 ? 0.0F : rows[b * rows.size() / count];
    bands[b].to = b + 1 == count ? 1.0F : rows[(b + 1) * rows.size() / count];
  }
  return bands;
}

/// How far apart the two bands' motions put what lies between them.
double jump_mm(const Band& a, const Band& b) {
  const Eigen::Vector3d between = 0.5 * (a.middle_mm + b.middle_mm);
  return (a.motion * between - b.motion * between).norm();
}

std::string millimetres(double mm) {
  const auto tenths = std::max(1L, std::lround(10.0 * mm));
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " mm";
}

}  // namespace

std::string reason_of(const ScanMotion& motion) {
  return "the tablet or the scanner moved during the scan, after about " +
         std::to_string(std::lround(100.0 * motion.row)) + " % of it, by " + millimetres(motion.shift_mm) +
         "; scan it again";
}

bool may_have_moved(const ScanSurface& scan, std::span<const ModelScan> model, const ModelFit& fit,
                    const ModelFitOptions& options) {
  const Fitted fitted{scan, model, fit, options, kLimits};
  const std::vector<Band> bands = bands_of(fitted);
  return std::ranges::any_of(bands, [&](const Band& band) {
    const SurfaceLevel fine = rows_of(*scan.fine, band.from, band.to);
    return start_of(fitted, band, fine, fitted.evidence(fine, fit.model_from_scanner)).has_value();
  });
}

std::optional<ScanMotion> find_motion(const ScanSurface& scan, std::span<const ModelScan> model,
                                      const ModelFit& fit, const ModelFitOptions& options, bool was_found) {
  const Fitted fitted{scan, model, fit, options, was_found ? kLimitsAgain : kLimits};
  std::vector<Band> bands = bands_of(fitted);
  parallel_for_each_index(
      bands.size(), [&](std::size_t b) { look_at(fitted, bands[b]); }, 1);
  std::erase_if(bands, [](const Band& band) { return !band.settled; });

  ScanMotion out;
  double largest_step_mm = 0;
  for (std::size_t b = 0; b < bands.size(); ++b) {
    out.gained += bands[b].gained;
    for (std::size_t other = 0; other < b; ++other) {
      out.shift_mm = std::max(out.shift_mm, jump_mm(bands[other], bands[b]));
    }
    if (b > 0 && jump_mm(bands[b - 1], bands[b]) > largest_step_mm) {
      largest_step_mm = jump_mm(bands[b - 1], bands[b]);
      out.row = 0.5 * static_cast<double>(bands[b - 1].to + bands[b].from);
    }
  }
  if (out.shift_mm < fitted.limits.least_spacings * scan.fine->spacing_mm) {
    return std::nullopt;
  }
  return out;
}

}  // namespace dubsar
