// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/surface_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/grid_lookup.h"
#include "core/order_statistics.h"
#include "core/parallel.h"
#include "core/units.h"
#include "planning/clearing.h"
#include "planning/sparse_flags.h"
#include "planning/surface_places.h"

namespace dubsar {

namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();
/// Scans that are looked at together: enough for some cores, few enough to bound the memory. The result does
/// not depend on it.
constexpr std::size_t kTogether = 4;

/// What one scan has of one place; nothing when it did not sample it well.
struct Sampled {
  float per_mm2 = 0;         ///< samples on the surface
  float spacing_mm = kNone;  ///< along the coarser of row and column
  float cosine = 0;          ///< of the angle between the normal and the worse of laser and camera
};

/// The link from a sample to its neighbours on both sides: per cell, over those that are near.
std::optional<Eigen::Vector3f> link(const RangeGrid& grid, std::size_t sample, bool along_row,
                                    float most_mm) {
  const int row = grid.row_of(sample);
  const int col = grid.col_of(sample);
  const Eigen::Vector3f p = grid.point(sample);
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  int sides = 0;
  for (const int step : {-1, 1}) {
    const int r = along_row ? row : row + step;
    const int c = along_row ? col + step : col;
    if (!grid.is_valid(r, c)) {
      continue;
    }
    const Eigen::Vector3f d = grid.point(grid.index(r, c)) - p;
    if (d.allFinite() && d.norm() <= most_mm) {
      sum += static_cast<float>(step) * d;
      ++sides;
    }
  }
  return sides > 0 ? std::optional<Eigen::Vector3f>(sum / static_cast<float>(sides)) : std::nullopt;
}

class ScanSampling {
 public:
  ScanSampling(const PlacedScan& scan, const SurfaceQualityOptions& options)
      : grid_(*scan.grid),
        scanner_from_model_(scan.model_from_scanner.inverse()),
        spacing_mm_(spacing_of(*scan.grid)),
        reach_mm_(static_cast<float>(
            std::min(options.reach_spacings * spacing_mm_ + options.reach_sigmas * finite(scan.sigma_mm),
                     options.most_reach_spacings * spacing_mm_))),
        lookup_(*scan.grid, unflagged(scan)) {}

  [[nodiscard]] Sampled at(const SurfacePlace& place) const {
    const Eigen::Vector3d p = scanner_from_model_ * place.position_mm.cast<double>();
    const std::int64_t nearest = lookup_.nearest(p.cast<float>(), reach_mm_);
    if (nearest < 0) {
      return {};
    }
    const auto sample = static_cast<std::size_t>(nearest);
    const Eigen::Vector3d n = scanner_from_model_.rotation * place.normal.cast<double>();
    const Eigen::Vector3d q = grid_.point(sample).cast<double>();
    const double row = grid_.row_of(sample);
    const double cosine = std::min(n.dot(grid_.view.to_camera(q, row)), n.dot(grid_.view.to_laser(q, row)));
    if (!(cosine > 0)) {
      return {};  // the other side of a thin rim
    }
    const auto most_mm = static_cast<float>(kGapInSpacings * spacing_mm_);
    const auto across = link(grid_, sample, true, most_mm);
    const auto along = link(grid_, sample, false, most_mm);
    if (!across || !along) {
      return {};
    }
    // Laid into the surface: noise along the normal makes no spacing.
    const Eigen::Vector3d x = across->cast<double>() - n * n.dot(across->cast<double>());
    const Eigen::Vector3d y = along->cast<double>() - n * n.dot(along->cast<double>());
    const double cell_mm2 = std::abs(n.dot(x.cross(y)));
    if (!(cell_mm2 > 0)) {
      return {};
    }
    return {static_cast<float>(1.0 / cell_mm2), static_cast<float>(std::max(x.norm(), y.norm())),
            static_cast<float>(std::min(1.0, cosine))};
  }

 private:
  static double finite(double value) { return std::isfinite(value) && value > 0 ? value : 0.0; }
  static std::vector<std::uint8_t> unflagged(const PlacedScan& scan) {
    std::vector<std::uint8_t> keep(scan.grid->size());
    for (std::size_t i = 0; i < keep.size(); ++i) {
      keep[i] = scan.grid->valid[i] != 0 && is_unflagged((*scan.flags)[i]) ? 1 : 0;
    }
    return keep;
  }

  const RangeGrid& grid_;
  RigidTransform scanner_from_model_;
  double spacing_mm_;
  float reach_mm_;
  GridLookup lookup_;
};

/// All scans together, of one place.
struct Together {
  float per_mm2 = 0;
  float single_mm = kNone;
  float cosine = 0;
  int scans = 0;

  void add(const Sampled& one) {
    if (one.per_mm2 > 0) {
      per_mm2 += one.per_mm2;
      single_mm = std::min(single_mm, one.spacing_mm);
      cosine = std::max(cosine, one.cosine);
      ++scans;
    }
  }
  [[nodiscard]] float spacing_mm() const { return per_mm2 > 0 ? 1.0F / std::sqrt(per_mm2) : kNone; }
  [[nodiscard]] float angle_rad() const { return scans > 0 ? std::acos(cosine) : kNone; }
};

Spread spread_of(std::vector<float>& values) {
  const auto at = [&](double part) {
    const auto k = static_cast<std::size_t>(part * static_cast<double>(values.size() - 1));
    return static_cast<double>(value_at_rank(values, k));
  };
  return values.empty() ? Spread{} : Spread{at(0.5), at(0.95)};
}

double share_within(const std::vector<float>& values, double limit) {
  const auto within = std::count_if(values.begin(), values.end(),
                                    [&](float value) { return static_cast<double>(value) <= limit; });
  return static_cast<double>(within) / static_cast<double>(values.size());
}

/// Over the places that `counts` names.
template <class Counts>
SamplingQuality quality_of(const std::vector<Together>& places, const Counts& counts) {
  SamplingQuality out;
  std::vector<float> spacing, single, angle;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!counts(i)) {
      continue;
    }
    const Together& place = places[i];
    spacing.push_back(place.spacing_mm());
    single.push_back(place.single_mm);
    angle.push_back(place.angle_rad());
    out.scans_share[std::min<std::size_t>(SamplingQuality::kScanBins - 1,
                                          static_cast<std::size_t>(place.scans))] += 1;
    if (place.scans > 0) {
      const auto bin = static_cast<std::size_t>(deg_from_rad(place.angle_rad()) / 10.0);
      out.incidence_share[std::min(SamplingQuality::kAngleBins - 1, bin)] += 1;
    }
  }
  if (spacing.empty()) {
    return out;
  }
  out.places = static_cast<std::int64_t>(spacing.size());
  for (double& share : out.scans_share) {
    share /= static_cast<double>(out.places);
  }
  for (double& share : out.incidence_share) {
    share /= static_cast<double>(out.places);
  }
  out.fine_share = share_within(spacing, kFineSpacingMm);
  out.single_fine_share = share_within(single, kFineSpacingMm);
  out.spacing_mm = spread_of(spacing);
  out.single_spacing_mm = spread_of(single);
  out.incidence_rad = spread_of(angle);
  return out;
}

}  // namespace

SurfaceQuality surface_quality(std::span<const PlacedScan> scans, const Mesh& mesh, const ModelFaces& faces,
                               const SurfaceQualityOptions& options) {
  const SurfacePlaces surface = surface_places(mesh, faces, options.places);
  SurfaceQuality out;
  out.seen_mm2 = surface.seen_mm2;
  out.interpolated_mm2 = surface.interpolated_mm2;
  std::vector<Together> together(surface.places.size());
  std::vector<std::vector<Sampled>> sampled(std::min(kTogether, scans.size()));
  for (std::size_t first = 0; first < scans.size() && !together.empty(); first += kTogether) {
    const std::size_t count = std::min(kTogether, scans.size() - first);
    parallel_for_each_index(
        count,
        [&](std::size_t k) {
          const ScanSampling sampling(scans[first + k], options);
          sampled[k].resize(surface.places.size());
          parallel_for_each_index(
              surface.places.size(), [&](std::size_t i) { sampled[k][i] = sampling.at(surface.places[i]); },
              2048);
        },
        1);
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t i = 0; i < together.size(); ++i) {
        together[i].add(sampled[k][i]);
      }
    }
  }
  out.all = quality_of(together, [](std::size_t) { return true; });
  for (int face = 0; face < kFaceCount; ++face) {
    out.faces[static_cast<std::size_t>(face)] = quality_of(
        together, [&](std::size_t i) { return surface.places[i].face == static_cast<Face>(face); });
  }
  return out;
}

}  // namespace dubsar
