// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/verify_pose.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/units.h"

namespace dubsar {

namespace {

/// What fits turned by less fits shifted.
constexpr double kLeastTurnRad = 0.15;

/// Of no use where pins are in the scans already.
constexpr const char* kOrUsePins = ", or use pins";
constexpr const char* kUsePins = ", use pins";

std::string percent(double share) {
  return std::to_string(std::lround(100.0 * share)) + " %";
}

/// The significance of the relief where shape or relief hold the scan in place. 0 where it can slide along
/// and the relief agrees as well: a moulding, a ruled line or a wheel mark agrees with itself all along, and
/// with others of its kind, and tells no pose from the next.
double telling_significance(const ModelFit& fit, const VerifyOptions& o) {
  const bool slides = fit.refined() && fit.icp.stability < o.least_stability &&
                      fit.slid_significance >= o.most_slid * fit.significance;
  return slides ? 0.0 : fit.significance;
}

double residual_doubt(const ModelFit& fit, const VerifyOptions& o) {
  if (!(fit.residual_sigma_mm > 0)) {
    return 0;
  }
  return std::max(0.0, fit.icp.rms_mm / fit.residual_sigma_mm - o.usual_residual) /
         (o.most_residual - o.usual_residual);
}

/// What overlap, fit and free space say, the relief left aside.
PoseVerdict judged_by_shape(const ModelFit& fit, const VerifyOptions& o) {
  const PoseEvidence both = fit.both();
  // Over the smaller of the two: one may be a scan that was broken off.
  const double overlap = std::max(fit.overlap, fit.best_pair_overlap);
  if (fit.outward.close + fit.inward.close < o.least_close || overlap < o.least_overlap) {
    if (overlap < 0.3 * o.least_overlap) {
      return {PoseStatus::kFailed,
              "no overlap with the registered scans was found; scan again with at least 30 % overlap"};
    }
    return {PoseStatus::kUnsure,
            "only " + percent(overlap) +
                " of it overlaps the registered scans; scan again with at least 30 % overlap"};
  }
  const bool relief_is_sure = sure(fit, o);
  // Real scanners see the same clay a little elsewhere from views far apart: the more scans the model has,
  // the fewer of a right one's samples agree with all of them. Where the relief has settled which pose it is,
  // the scan that it shares most with tells how well it lies; free space is asked of all.
  const double beside_partner = std::max(0.0, fit.partner_agreement - both.agreement());
  const double total = doubt(fit, o) - (relief_is_sure ? beside_partner / o.most_disagreement : 0.0);
  if (total > (relief_is_sure ? o.sure_doubt : 1.0)) {
    const PoseStatus status = total > 3.0 ? PoseStatus::kFailed : PoseStatus::kUnsure;
    const double off = (1.0 - both.agreement()) / o.most_disagreement;
    const double through = both.violation() / o.most_violation;
    const double gone = both.absence() / o.most_absence;
    const double apart = residual_doubt(fit, o);
    if (apart >= off && apart >= through && apart >= gone) {
      return {status,
              "the surfaces lie farther apart than noise explains; scan again with more overlap, or check "
              "that nothing "
              "moved during the scan"};
    }
    if (off >= through && off >= gone) {
      return {status,
              "the surfaces agree in only " + percent(both.agreement()) +
                  " of the overlap; scan again with more overlap, or click three points on both scans"};
    }
    if (through >= gone) {
      return {
          status,
          percent(both.violation()) +
              " of it would stand where another scan saw through; click three points on both scans, or take "
              "away what moved"};
    }
    return {
        status,
        percent(both.absence()) +
            " of the surface that one scan shows is missing from another that looked there; scan again with "
            "more overlap, or click three points on both scans"};
  }
  if (fit.told_by_rig && !relief_is_sure && apart_beyond_noise(fit, o)) {
    return {PoseStatus::kUnsure, not_the_same_clay()};
  }
  if (fit.refined() && fit.icp.stability < o.least_stability && !relief_is_sure) {
    return {PoseStatus::kUnsure,
            too_even(fit.icp.weakest.head<3>().norm() > fit.icp.weakest.tail<3>().norm())};
  }
  return {PoseStatus::kRegistered, {}};
}

bool shape_settles(const ModelFit& fit, const VerifyOptions& o) {
  return fit.distinctive && fit.overlap >= o.shape_overlap && fit.both().agreement() >= o.shape_agreement &&
         doubt(fit, o) <= o.shape_doubt;
}

PoseVerdict two_poses(double turn_rad) {
  return {PoseStatus::kUnsure, "two poses fit, " + std::to_string(std::lround(deg_from_rad(turn_rad))) +
                                   " degrees apart; click one point on both scans"};
}

PoseVerdict two_poses(const ModelFit& a, const ModelFit& b) {
  return two_poses((b.model_from_scanner * a.model_from_scanner.inverse()).angle_rad());
}

}  // namespace

bool sure(const ModelFit& fit, const VerifyOptions& options) {
  // However firmly the shape holds it: lines of another tablet of the same make fall together a little way
  // off, too.
  const bool as_well_beside =
      fit.refined() && fit.slid_significance >= options.most_slid_held * fit.significance;
  return !fit.repeats_turned_rad && !as_well_beside &&
         telling_significance(fit, options) >= options.sure_relief &&
         fit.significance_off_rims >= options.least_off_rims * fit.significance &&
         fit.relief.correlation() >= options.sure_correlation;
}

bool apart_beyond_noise(const ModelFit& fit, const VerifyOptions& options) {
  return fit.refined() && fit.places > 0 &&
         fit.icp.rms_mm >
             (1.0 + options.rig_residual_deviations / std::sqrt(2.0 * fit.places)) * fit.residual_sigma_mm;
}

std::string not_the_same_clay() {
  return "the surfaces lie farther apart than noise explains, and nothing written agrees: another tablet may "
         "lie there; check that it is the same one, and scan it again";
}

std::string too_even(bool turns) {
  return std::string("the overlap is too even: the scan can ") + (turns ? "turn" : "slide") +
         " on it; scan again with an edge or more relief in the overlap" + kOrUsePins;
}

std::string without_pins_advised(std::string reason) {
  for (const std::string_view advice : {kOrUsePins, kUsePins}) {
    if (const std::size_t at = reason.find(advice); at != std::string::npos) {
      reason.erase(at, advice.size());
    }
  }
  return reason;
}

double doubt(const ModelFit& fit, const VerifyOptions& options) {
  const PoseEvidence evidence = fit.both();
  return (1.0 - evidence.agreement()) / options.most_disagreement +
         evidence.violation() / options.most_violation + evidence.absence() / options.most_absence +
         residual_doubt(fit, options);
}

PoseVerdict verify_pose(std::vector<ModelFit>& fits, const VerifyOptions& options) {
  if (fits.empty()) {
    return {
        PoseStatus::kFailed,
        "nothing in it resembles the registered scans; scan again with at least 30 % overlap, or click three "
        "points on both scans"};
  }
  const auto fits_shape = [&](const ModelFit& fit) {
    return judged_by_shape(fit, options).status == PoseStatus::kRegistered;
  };
  const auto acceptable = [&](const ModelFit& fit) {
    return fit.refined() && (fit.told || sure(fit, options) || shape_settles(fit, options)) &&
           fits_shape(fit);
  };
  auto best = sure(fits.front(), options) && acceptable(fits.front()) ? fits.begin() : fits.end();
  const bool settled = best != fits.end();
  for (auto fit = fits.begin(); fit != fits.end() && !settled; ++fit) {
    if (fit->score > options.rival_score * fits.front().score && acceptable(*fit) &&
        (best == fits.end() || doubt(*fit, options) < doubt(*best, options))) {
      best = fit;
    }
  }
  if (best == fits.end()) {
    const auto first = std::find_if(fits.begin(), fits.end(), fits_shape);
    if (first == fits.end()) {
      return judged_by_shape(fits.front(), options);
    }
    const auto second = std::find_if(first + 1, fits.end(), fits_shape);
    if (second == fits.end() && first->repeats_turned_rad.value_or(0.0) > kLeastTurnRad) {
      return two_poses(*first->repeats_turned_rad);
    }
    return second != fits.end()
               ? two_poses(*first, *second)
               : PoseVerdict{
                     PoseStatus::kUnsure,
                     "too little is written or broken in the overlap to tell this pose from others; scan "
                     "again with more overlap" +
                         std::string(kUsePins) + ", or click one point on both scans"};
  }
  std::rotate(fits.begin(), best, best + 1);
  const ModelFit& chosen = fits.front();
  const double least = options.rival_gap + options.rival_ratio * doubt(chosen, options);
  for (auto rival = fits.begin() + 1; rival != fits.end(); ++rival) {
    if (chosen.told && !rival->told) {
      continue;
    }
    if (sure(chosen, options) &&
        telling_significance(*rival, options) < options.rival_relief * chosen.significance) {
      continue;
    }
    if (rival->score > options.rival_score * chosen.score && doubt(*rival, options) < least) {
      return two_poses(chosen, *rival);
    }
  }
  return {PoseStatus::kRegistered, {}};
}

bool consistent_pose(const ModelFit& fit, const VerifyOptions& options) {
  const PoseEvidence both = fit.both();
  const bool enough = both.close + both.apart >= options.least_close;
  return enough ? doubt(fit, options) <= 1.0 : both.violation() <= options.most_violation;
}

}  // namespace dubsar
