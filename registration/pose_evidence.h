// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/rigid_transform.h"
#include "registration/scan_surface.h"

namespace dubsar {

/// What the samples of one scan say about its pose against what another scan's camera saw, counted in
/// samples.
struct PoseEvidence {
  int sent = 0;   ///< samples that were looked at
  int close = 0;  ///< on the other's surface within the tolerance, normals compatible
  int apart =
      0;  ///< near the other's surface (within the band), but off by more than the tolerance, or turned
  int in_front = 0;       ///< the other's rays went through this place: free space
  int missing = 0;        ///< facing the other's camera, nothing in front, and yet it saw nothing there
  double sum_r2_mm2 = 0;  ///< of the point-to-plane residuals of the close samples

  void add(const PoseEvidence& b) {
    sent += b.sent;
    close += b.close;
    apart += b.apart;
    in_front += b.in_front;
    missing += b.missing;
    sum_r2_mm2 += b.sum_r2_mm2;
  }
  /// Of the samples where both saw the surface, how many agree.
  [[nodiscard]] double agreement() const {
    return close + apart == 0 ? 0.0 : static_cast<double>(close) / (close + apart);
  }
  /// Of the samples that say something, how many contradict the pose by free space.
  [[nodiscard]] double violation() const {
    return close + apart + in_front == 0 ? 0.0 : static_cast<double>(in_front) / (close + apart + in_front);
  }
  /// Of the samples that the other camera should have seen, how many it did not.
  [[nodiscard]] double absence() const {
    return close + missing == 0 ? 0.0 : static_cast<double>(missing) / (close + missing);
  }
};

struct EvidenceOptions {
  double tolerance_mm = 0.1;  ///< residual of a close sample
  double band_mm = 1.0;       ///< farther apart along the view than this is another surface, or free space
  int most_samples = 1 << 30;
};

/// Sends `source`'s samples into `target` (target_from_source) and counts. When `close_marks` is given it
/// becomes [samples], 1 where a sample was close.
[[nodiscard]] PoseEvidence pose_evidence(const SurfaceLevel& source, const SurfaceLevel& target,
                                         const RigidTransform& target_from_source,
                                         const EvidenceOptions& options,
                                         std::vector<std::uint8_t>* close_marks = nullptr);

}  // namespace dubsar
