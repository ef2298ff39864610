// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/model_fit.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "registration/global_align.h"

namespace dubsar {

namespace {

constexpr double kFreeSpaceWeight = 2.0;
/// A rough pose whose relief agrees like this is seldom chance: closer, it may agree far better.
constexpr double kHopefulRelief = 2.0;

struct Start {
  RigidTransform pose;
  double score = 0;
  double significance = 0;
};

double significance_of(const Start& start) {
  return start.significance;
}

bool better(const ModelFit& a, const ModelFit& b) {
  return a.score > b.score;
}

/// The relief of the scan against that of all scans of the model. Clay that several of them show counts once.
ReliefAgreement relief_in_model(const ScanSurface& scan, std::span<const ModelScan> model,
                                const RigidTransform& pose, double tolerance_mm) {
  ReliefAgreement sum;
  for (const ModelScan& m : model) {
    sum.add(relief_agreement(*scan.medium, scan.relief, *m.surface->medium, m.surface->relief,
                             m.model_from_scanner.inverse() * pose, tolerance_mm));
  }
  sum.area_mm2 =
      std::min(sum.area_mm2, scan.relief.cell_area_mm2 * static_cast<double>(scan.relief.cells.size()));
  return sum;
}

/// For comparing rough poses of one scan.
Start coarse_support(const ScanSurface& scan, std::span<const ModelScan> model, const RigidTransform& pose,
                     const EvidenceOptions& options) {
  PoseEvidence sum;
  for (const ModelScan& m : model) {
    const RigidTransform m_from_scan = m.model_from_scanner.inverse() * pose;
    sum.add(pose_evidence(*scan.coarse, *m.surface->coarse, m_from_scan, options));
    sum.add(pose_evidence(*m.surface->coarse, *scan.coarse, m_from_scan.inverse(), options));
  }
  // A share of all that was sent, however many scans there are: what relief says must not drown in it.
  const double shape =
      sum.sent == 0 ? 0.0 : (sum.close - kFreeSpaceWeight * sum.in_front) / static_cast<double>(sum.sent);
  const double significance =
      relief_in_model(scan, model, pose, options.tolerance_mm).significance(scan.relief.radius_mm);
  return {pose, pose_support(shape, significance), significance};
}

/// A scan of the model and how many samples it shares with the fitted one.
struct Shared {
  std::size_t place = 0;
  int close = 0;
};

/// The places of those that share the most, in the model's order.
std::vector<std::size_t> strongest(std::vector<Shared> shared, std::size_t most) {
  std::stable_sort(shared.begin(), shared.end(),
                   [](const Shared& a, const Shared& b) { return a.close > b.close; });
  shared.resize(std::min(shared.size(), most));
  std::vector<std::size_t> out;
  out.reserve(shared.size());
  for (const Shared& s : shared) {
    out.push_back(s.place);
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// The scans of the model that the scan overlaps most in this pose.
std::vector<std::size_t> touched(const ScanSurface& scan, std::span<const ModelScan> model,
                                 const RigidTransform& pose, const EvidenceOptions& options, int least,
                                 std::size_t most) {
  std::vector<Shared> out;
  for (std::size_t k = 0; k < model.size(); ++k) {
    const RigidTransform m_from_scan = model[k].model_from_scanner.inverse() * pose;
    const PoseEvidence e = pose_evidence(*scan.coarse, *model[k].surface->coarse, m_from_scan, options);
    if (e.close >= least) {
      out.push_back({k, e.close});
    }
  }
  return strongest(std::move(out), most);
}

using LevelOf = std::unique_ptr<SurfaceLevel> ScanSurface::*;

IcpResult icp_in_model(const ScanSurface& scan, std::span<const ModelScan> model,
                       const std::vector<std::size_t>& members, LevelOf level, const RigidTransform& start,
                       const IcpOptions& options) {
  return icp(*(scan.*level), targets_of(model, members, level), start, options);
}

EvidenceOptions fine_evidence(const ScanSurface& scan, const ScanSurface& other,
                              const ModelFitOptions& options) {
  EvidenceOptions evidence;
  evidence.tolerance_mm = options.tolerance_sigmas * residual_sigma_mm(scan, other, options);
  evidence.band_mm = options.band * scan.scale_mm;
  return evidence;
}

void keep_distinct(std::vector<Start>& starts, std::size_t most, const Eigen::Vector3d& center_mm,
                   const ModelFitOptions& options, double scale_mm) {
  std::stable_sort(starts.begin(), starts.end(),
                   [](const Start& a, const Start& b) { return a.score > b.score; });
  std::vector<Start> kept;
  for (const Start& s : starts) {
    if (kept.size() < most &&
        (kept.size() < 2 || s.score > options.hopeless * kept.front().score ||
         s.significance > kHopefulRelief) &&
        std::none_of(kept.begin(), kept.end(), [&](const Start& k) {
          return same_pose(s.pose, k.pose, center_mm, options.distinct_turn_rad,
                           options.distinct_shift * scale_mm);
        })) {
      kept.push_back(s);
    }
  }
  starts = std::move(kept);
}

}  // namespace

double residual_sigma_mm(const ScanSurface& a, const ScanSurface& b, const ModelFitOptions& options) {
  const double spacing_mm = std::max(a.fine->spacing_mm, b.fine->spacing_mm);
  return std::hypot(a.noise_mm, b.noise_mm, options.systematic_of_spacing * spacing_mm);
}

PoseEvidence evidence_of_part(const SurfaceLevel& part, const ScanSurface& scan,
                              std::span<const ModelScan> model, const std::vector<std::size_t>& targets,
                              const RigidTransform& model_from_scanner, const ModelFitOptions& options) {
  PoseEvidence sum;
  for (const std::size_t k : targets) {
    const ScanSurface& other = *model[k].surface;
    sum.add(pose_evidence(part, *other.fine, model[k].model_from_scanner.inverse() * model_from_scanner,
                          fine_evidence(scan, other, options)));
  }
  return sum;
}

std::vector<IcpTarget> targets_of(std::span<const ModelScan> model, const std::vector<std::size_t>& members,
                                  std::unique_ptr<SurfaceLevel> ScanSurface::*level) {
  std::vector<IcpTarget> targets;
  targets.reserve(members.size());
  for (const std::size_t k : members) {
    targets.push_back({(model[k].surface->*level).get(), model[k].model_from_scanner});
  }
  return targets;
}

IcpResult refine_fine(const SurfaceLevel& source, std::span<const IcpTarget> targets,
                      const RigidTransform& start, double residual_sigma_mm) {
  IcpOptions fine;
  fine.iterations = 8;
  fine.converged_mm = 0.03 * residual_sigma_mm;
  IcpResult result;
  result.model_from_source = start;
  for (const double sigmas : {4.0, 1.5}) {
    fine.kernel_mm = sigmas * residual_sigma_mm;
    fine.reach_mm = std::max(2.0 * source.spacing_mm, 5.0 * fine.kernel_mm);
    result = icp(source, targets, result.model_from_source, fine);
  }
  return result;
}

ModelFit judge_in_model(const ScanSurface& scan, std::span<const ModelScan> model,
                        const RigidTransform& model_from_scanner, const ModelFitOptions& options) {
  ModelFit out;
  out.model_from_scanner = model_from_scanner;
  std::vector<PoseEvidence> outward(model.size());
  std::vector<PoseEvidence> inward(model.size());
  std::vector<std::vector<std::uint8_t>> marks(model.size());
  parallel_for_each_index(
      model.size(),
      [&](std::size_t k) {
        const ScanSurface& other = *model[k].surface;
        const EvidenceOptions evidence = fine_evidence(scan, other, options);
        const RigidTransform other_from_scan = model[k].model_from_scanner.inverse() * model_from_scanner;
        outward[k] = pose_evidence(*scan.fine, *other.fine, other_from_scan, evidence, &marks[k]);
        inward[k] = pose_evidence(*other.fine, *scan.fine, other_from_scan.inverse(), evidence);
      },
      1);
  const std::size_t samples = scan.fine->samples.size();
  std::vector<std::uint8_t> on_model(samples, 0);
  std::vector<Shared> shared;
  int most_shared = 0;
  double sigma_sum = 0;
  double sigma_weight = 0;
  for (std::size_t k = 0; k < model.size(); ++k) {
    out.outward.add(outward[k]);
    out.inward.add(inward[k]);
    const auto share = [](const PoseEvidence& e) {
      return e.sent == 0 ? 0.0 : static_cast<double>(e.close) / e.sent;
    };
    const double pair = std::max(share(outward[k]), share(inward[k]));
    out.best_pair_overlap = std::max(out.best_pair_overlap, pair);
    for (std::size_t i = 0; i < samples; ++i) {
      on_model[i] |= marks[k][i];
    }
    if (pair > 0.02) {
      out.touching.push_back(k);
      shared.push_back({k, outward[k].close + inward[k].close});
      if (shared.back().close > most_shared) {
        most_shared = shared.back().close;
        PoseEvidence with_partner = outward[k];
        with_partner.add(inward[k]);
        out.partner_agreement = with_partner.agreement();
      }
    }
    sigma_sum += (outward[k].close + 1e-9) * residual_sigma_mm(scan, *model[k].surface, options);
    sigma_weight += outward[k].close + 1e-9;
  }
  out.targets = strongest(std::move(shared), options.most_targets);
  out.residual_sigma_mm = sigma_weight > 0 ? sigma_sum / sigma_weight : 0;
  if (samples > 0) {
    const auto on = std::count(on_model.begin(), on_model.end(), std::uint8_t{1});
    out.overlap = static_cast<double>(on) / static_cast<double>(samples);
  }
  const PoseEvidence both = out.both();
  const double shape = out.overlap * both.agreement() *
                       std::max(0.0, 1.0 - kFreeSpaceWeight * both.violation()) * (1.0 - both.absence());
  out.relief = relief_in_model(scan, model, model_from_scanner, options.coarse_tolerance * scan.scale_mm);
  out.significance = out.relief.significance(scan.relief.radius_mm);
  out.significance_off_rims = out.relief.significance_off_rims(scan.relief.radius_mm);
  out.places = out.relief.places(scan.relief.radius_mm);
  out.score = pose_support(shape, out.significance);
  return out;
}

namespace {

/// What the relief says when the scan is slid, or turned, along the direction that its shape holds least: as
/// far as half of what the relief is measured against.
double slid_significance(const ScanSurface& scan, std::span<const ModelScan> model, const IcpResult& icp,
                         const ModelFitOptions& options) {
  double most = 0;
  for (const double side : {-0.5, 0.5}) {
    const double step_mm = side * scan.relief.radius_mm;
    // `weakest` has its turns scaled to displacement at the scan's rms radius.
    const double radius_mm = std::max(0.5 * scan.extent_mm, 1e-6);
    const RigidTransform turn =
        RigidTransform::from_twist(step_mm / radius_mm * icp.weakest.head<3>(), Eigen::Vector3d::Zero());
    RigidTransform pose = icp.model_from_source;
    pose.rotation = turn.rotation * pose.rotation;
    pose.translation_mm = turn.rotation * (pose.translation_mm - icp.center_mm) + icp.center_mm +
                          step_mm * icp.weakest.tail<3>();
    most = std::max(most, relief_in_model(scan, model, pose, options.coarse_tolerance * scan.scale_mm)
                              .significance(scan.relief.radius_mm));
  }
  return most;
}

/// Takes starts from anywhere in the ICP's reach to within that of the fine level.
std::vector<ModelFit> approach(const ScanSurface& scan, std::span<const ModelScan> model,
                               std::span<const RigidTransform> starts, const ModelFitOptions& options) {
  const double scale_mm = scan.scale_mm;
  EvidenceOptions rough;
  rough.tolerance_mm = std::max(options.coarse_tolerance * scale_mm, 0.5 * scan.coarse->spacing_mm);
  rough.band_mm = options.band * scale_mm;
  std::vector<Start> tried(starts.size());
  parallel_for_each_index(
      starts.size(), [&](std::size_t k) { tried[k] = coarse_support(scan, model, starts[k], rough); }, 1);
  drop_outdone(tried, significance_of);
  keep_distinct(tried, static_cast<std::size_t>(2 * options.most_medium), scan.centroid_mm, options,
                scale_mm);

  IcpOptions step;
  step.normal_cosine = 0.6;
  step.converged_mm = 2e-4 * scale_mm;
  parallel_for_each_index(
      tried.size(),
      [&](std::size_t k) {
        IcpOptions coarse = step;
        coarse.reach_mm = 0.06 * scale_mm;
        coarse.kernel_mm = 0.012 * scale_mm;
        EvidenceOptions wide = rough;
        wide.tolerance_mm *= 2.0;
        const auto members = touched(scan, model, tried[k].pose, wide, options.least_overlap_samples / 2,
                                     options.most_targets);
        tried[k].pose =
            icp_in_model(scan, model, members, &ScanSurface::coarse, tried[k].pose, coarse).model_from_source;
        tried[k] = coarse_support(scan, model, tried[k].pose, rough);
      },
      1);
  drop_outdone(tried, significance_of);
  keep_distinct(tried, static_cast<std::size_t>(options.most_medium), scan.centroid_mm, options, scale_mm);

  // Most starts are wrong, and one medium pass shows it: only what is left deserves the closer ones.
  std::vector<ModelFit> fits(tried.size());
  for (const double reach : {0.03, 0.012}) {
    parallel_for_each_index(
        fits.size(),
        [&](std::size_t k) {
          if (reach == 0.03) {
            fits[k].model_from_scanner = tried[k].pose;
          }
          RigidTransform& pose = fits[k].model_from_scanner;
          const auto members =
              touched(scan, model, pose, rough, options.least_overlap_samples, options.most_targets);
          IcpOptions medium = step;
          medium.iterations = 10;
          medium.reach_mm = std::max(reach * scale_mm, 2.0 * scan.medium->spacing_mm);
          medium.kernel_mm = std::max(0.12 * reach * scale_mm, 0.2 * scan.medium->spacing_mm);
          pose = icp_in_model(scan, model, members, &ScanSurface::medium, pose, medium).model_from_source;
          fits[k] = judge_in_model(scan, model, pose, options);
        },
        1);
    std::stable_sort(fits.begin(), fits.end(), better);
    drop_outdone(fits, [](const ModelFit& fit) { return fit.significance; });
    while (fits.size() > 1 && fits.back().score < options.hopeless * fits.front().score) {
      fits.pop_back();
    }
  }
  return fits;
}

}  // namespace

std::vector<ModelFit> fit_to_model(const ScanSurface& scan, std::span<const ModelScan> model,
                                   std::span<const RigidTransform> starts, const ModelFitOptions& options) {
  if (scan.fine->samples.empty() || model.empty() || starts.empty()) {
    return {};
  }
  std::vector<ModelFit> fits;
  if (options.starts_are_close) {
    for (const RigidTransform& start : starts) {
      fits.push_back(judge_in_model(scan, model, start, options));
    }
    std::stable_sort(fits.begin(), fits.end(), better);
  } else {
    fits = approach(scan, model, starts, options);
  }
  if (fits.size() > static_cast<std::size_t>(options.most_fine)) {
    fits.resize(static_cast<std::size_t>(options.most_fine));
  }
  for (ModelFit& fit : fits) {
    if (fit.significance < options.least_significance && options.least_significance > 0) {
      continue;
    }
    const IcpResult result = refine_fine(*scan.fine, targets_of(model, fit.targets, &ScanSurface::fine),
                                         fit.model_from_scanner, fit.residual_sigma_mm);
    fit = judge_in_model(scan, model, result.model_from_source, options);
    fit.icp = result;
    fit.slid_significance = slid_significance(scan, model, result, options);
  }
  std::stable_sort(fits.begin(), fits.end(), better);
  std::vector<ModelFit> out;
  for (ModelFit& fit : fits) {
    if (std::none_of(out.begin(), out.end(), [&](const ModelFit& o) {
          return same_pose(fit.model_from_scanner, o.model_from_scanner, scan.centroid_mm,
                           options.distinct_turn_rad, options.distinct_shift * scan.scale_mm);
        })) {
      out.push_back(std::move(fit));
    }
  }
  return out;
}

}  // namespace dubsar
