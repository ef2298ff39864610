// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/job.h"
#include "core/range_grid.h"
#include "core/result.h"
#include "formats/artefact_toml.h"

namespace dubsar {

/// Of the samples that lie on a part, as the guideline allows.
inline constexpr double kMayBeLeftOut = 0.003;

/// Samples that lie where a part of the artefact is, and are not on it.
struct LeftOut {
  std::size_t count = 0;
  double farthest_mm = 0;
  void add(double off_mm) {
    ++count;
    farthest_mm = off_mm > farthest_mm ? off_mm : farthest_mm;
  }
  /// `samples`: that are on it.
  [[nodiscard]] bool too_many(std::size_t samples) const {
    return static_cast<double>(count) > kMayBeLeftOut * static_cast<double>(count + samples);
  }
};

/// One ball as it was measured.
struct MeasuredBall {
  std::size_t certified = 0;           ///< index into Artefact::balls
  Eigen::Vector3d center_mm{0, 0, 0};  ///< scanner frame
  double diameter_mm = 0;              ///< of the free least-squares sphere
  double form_mm = 0;                  ///< probing error (form): range of the distances from that sphere
  double size_mm = 0;                  ///< probing error (size): measured less certified diameter
  std::size_t samples = 0;
  LeftOut left_out;            ///< before its face
  std::size_t parts_seen = 0;  ///< of its face, of kFaceParts
};

struct MeasuredSpacing {
  std::size_t a = 0;
  std::size_t b = 0;    ///< indices into Artefact::balls
  double error_mm = 0;  ///< measured less certified distance of the centres
};

/// An artefact's measurement in the terms of VDI/VDE 2634 part 2.
struct Verification {
  std::vector<MeasuredBall> balls;
  std::vector<MeasuredSpacing> spacings;
  std::optional<double> flatness_mm;  ///< range of the distances from the least-squares plane
  std::size_t plane_samples = 0;
  LeftOut plane_left_out;  ///< within its outline
  /// Sides of the smallest rectangle around what was seen of it, the longer one first.
  std::array<double, 2> plane_mm{0, 0};
  std::vector<std::string> failed;  ///< each limit that is not kept, and each part that was not found
  [[nodiscard]] bool passed() const { return failed.empty(); }
  /// The largest deviation from the certificate, mm.
  [[nodiscard]] double worst_mm() const;
};

/// Measures the artefact in one scan. Spheres and plane are found by random samples (seeded), fitted by least
/// squares; three in a thousand samples may be left out, as the guideline allows, more fail. Of a ball what
/// is within 60° of the view counts, and three quarters of that have to be seen. A plane whose size is known
/// has to be seen over nine tenths of both its sides: the flatness of a small part is always good. Errors
/// (kBadInput): no sample at all; kCancelled.
[[nodiscard]] Result<Verification> verify_artefact(const RangeGrid& grid, const Artefact& artefact,
                                                   const JobContext& job = {});

}  // namespace dubsar
