// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/accuracy_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "core/order_statistics.h"
#include "core/parallel.h"
#include "planning/clearing.h"

namespace dubsar {

namespace {

/// How well the planner knew what a scan would clear; nothing where none was asked for.
std::optional<std::string> prediction_sentence(const std::vector<ViewGain>& gains) {
  std::vector<double> off;
  for (const ViewGain& gain : gains) {
    if (gain.predicted_mm2 && gain.actual_mm2 > 0) {
      off.push_back(std::abs(*gain.predicted_mm2 - gain.actual_mm2) / gain.actual_mm2);
    }
  }
  if (off.empty()) {
    return std::nullopt;
  }
  return fmt::format(
      "What each scan would clear was predicted to within {:.0f} % of what it did clear (median of {} "
      "scans).",
      100 * median_of(off), off.size());
}

/// Of the scans in the model.
void tell_of_fit(const std::vector<ScanPose>& registered, std::vector<std::string>& out) {
  double worst_sigma_mm = 0;
  double worst_rms_mm = 0;
  bool any = false;
  for (const ScanPose& pose : registered) {
    worst_sigma_mm = std::max(worst_sigma_mm, pose.sigma_mm);
    worst_rms_mm = std::max(worst_rms_mm, pose.rms_mm);
    any = any || was_compared(pose);
  }
  if (!any) {
    if (!registered.empty()) {
      out.emplace_back(registered.size() == 1
                           ? "One scan is in the model: there is no other that it could be held against."
                           : "No two scans of the model overlap: none was held against another.");
    }
    return;
  }
  out.push_back(fmt::format(
      "Where scans overlap, their surfaces lie within {:.1f} µm RMS of each other in the worst scan.",
      1000 * worst_rms_mm));
  out.push_back(fmt::format(
      "The predicted error of a scan's place is at most {:.1f} µm (one standard deviation), from the "
      "overlaps alone; the calibration of the scanner comes on top.",
      1000 * worst_sigma_mm));
}

/// The scanner's own part; nothing where no scan tells.
std::optional<std::string> noise_sentence(std::span<const PlacedScan> placed) {
  std::vector<double> noise_mm(placed.size());
  parallel_for_each_index(
      placed.size(), [&](std::size_t s) { noise_mm[s] = noise_of(placed[s]); }, 1);
  std::erase_if(noise_mm, [](double mm) { return !(mm > 0); });
  if (noise_mm.empty()) {
    return std::nullopt;
  }
  const std::string of_several = fmt::format(", median of {} scans; {:.1f} µm in the worst", noise_mm.size(),
                                             1000 * *std::ranges::max_element(noise_mm));
  return fmt::format(
      "From sample to sample a scan scatters by {:.1f} µm along its view (noise, one standard "
      "deviation{}).",
      1000 * median_of(noise_mm), noise_mm.size() == 1 ? "" : of_several);
}

}  // namespace

std::vector<std::string> accuracy_sentences(const std::vector<ScanPose>& poses,
                                            std::span<const PlacedScan> placed,
                                            const std::vector<ViewGain>& gains) {
  std::vector<ScanPose> registered;
  std::ranges::copy_if(poses, std::back_inserter(registered),
                       [](const ScanPose& pose) { return pose.status == PoseStatus::kRegistered; });
  std::vector<std::string> out;
  tell_of_fit(registered, out);
  if (auto noise = noise_sentence(placed)) {
    out.push_back(std::move(*noise));
  }
  for (const ScanPose& pose : registered) {
    if (!pose.warning.empty()) {
      out.push_back(
          fmt::format("Scan {} is in the model, and a warning stands of it: {}.", pose.id, pose.warning));
    }
  }
  if (auto prediction = prediction_sentence(gains)) {
    out.push_back(std::move(*prediction));
  }
  return out;
}

}  // namespace dubsar
