// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/wedge_features.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/units.h"

namespace dubsar {

namespace {

constexpr double kLogScale = 0.2;  // of a length's logarithm
constexpr double kAngleScaleDeg = 8;
/// A wedge whose directional edge leads by no more than this is a Winkelhaken.
constexpr double kStubby = 0.3;
constexpr double kKindDeg = 25;
/// An edge that is flatter goes on as if it rose by this (sine).
constexpr double kLeastRise = 0.03;

double on_scale(std::size_t feature, double value) {
  return feature < kWedgeLengths ? std::log(std::max(value, 1e-3)) / kLogScale : value / kAngleScaleDeg;
}

using Quantiles = std::array<double, kProfileQuantiles>;

/// Linear between values; 0 of none.
Quantiles quantiles_of(std::vector<double> values) {
  Quantiles out{};
  std::ranges::sort(values);
  for (std::size_t q = 0; q < kProfileQuantiles && !values.empty(); ++q) {
    const double at = static_cast<double>(values.size() - 1) * static_cast<double>(q + 1) /
                      static_cast<double>(kProfileQuantiles + 1);
    const auto low = static_cast<std::size_t>(at);
    const std::size_t high = std::min(low + 1, values.size() - 1);
    const double part = at - static_cast<double>(low);
    out[q] = (1 - part) * values[low] + part * values[high];
  }
  return out;
}

enum class AnglesOf { kAll, kReadable };

WedgeProfile profile_of(std::optional<Face> side, const std::vector<const Wedge*>& wedges, AnglesOf angles) {
  WedgeProfile profile;
  profile.side = side;
  profile.count = static_cast<int>(wedges.size());
  std::array<std::vector<double>, kWedgeFeatures.size()> values;
  for (const Wedge* wedge : wedges) {
    const WedgeFeatures features = wedge_features(*wedge);
    const bool readable = angles == AnglesOf::kAll || has_readable_angles(*wedge);
    for (std::size_t f = 0; f < features.size(); ++f) {
      if (!std::isnan(features[f]) && (f < kWedgeLengths || readable)) {
        values[f].push_back(features[f]);
      }
    }
    profile.beyond_mesh += static_cast<int>(std::ranges::count(wedge->beyond_mesh, true));
    profile.kinds[kind_of(*wedge)] += 1.0 / static_cast<double>(wedges.size());
  }
  for (std::size_t f = 0; f < values.size(); ++f) {
    profile.known[f] = static_cast<int>(values[f].size());
    profile.quantiles[f] = quantiles_of(std::move(values[f]));
  }
  return profile;
}

std::vector<WedgeProfile> profiles_of(const std::vector<Wedge>& wedges, AnglesOf angles) {
  std::vector<WedgeProfile> profiles;
  std::vector<const Wedge*> all;
  for (const Wedge& wedge : wedges) {
    all.push_back(&wedge);
  }
  profiles.push_back(profile_of(std::nullopt, all, angles));
  for (int side = 0; side < kFaceCount; ++side) {
    std::vector<const Wedge*> some;
    std::ranges::copy_if(all, std::back_inserter(some), [&](const Wedge* w) {
      return w->place.side && *w->place.side == static_cast<Face>(side);
    });
    if (!some.empty()) {
      profiles.push_back(profile_of(static_cast<Face>(side), some, angles));
    }
  }
  return profiles;
}

}  // namespace

WedgeFeatures wedge_features(const Wedge& wedge) {
  WedgeFeatures f{};
  const auto d = static_cast<std::size_t>(wedge.directional_edge);
  f[0] = wedge.depth_mm;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t edge = (d + k) % 3;
    f[1 + k] = wedge.beyond_mesh[edge] ? std::numeric_limits<double>::quiet_NaN()
                                       : (wedge.exit_points_mm[edge] - wedge.depth_point_mm).norm();
    f[5 + k] = deg_from_rad(wedge.opening_angles_rad[edge]);
    f[8 + k] = deg_from_rad(wedge.face_angles_rad[edge]);
  }
  f[4] = deg_from_rad(wedge.edge_slopes_rad[d]);
  return f;
}

bool has_readable_angles(const Wedge& wedge) {
  return wedge.intact >= kLeastIntact && wedge.roundness <= kMostRoundness;
}

std::vector<float> comparable(const Wedge& wedge) {
  WedgeFeatures features = wedge_features(wedge);
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::isnan(features[1 + k])) {
      const std::size_t edge = (static_cast<std::size_t>(wedge.directional_edge) + k) % 3;
      features[1 + k] = wedge.depth_mm / std::max(std::sin(wedge.edge_slopes_rad[edge]), kLeastRise);
    }
  }
  std::vector<float> out;
  for (std::size_t f = 0; f < features.size(); ++f) {
    out.push_back(static_cast<float>(on_scale(f, features[f])));
  }
  return out;
}

std::size_t kind_of(const Wedge& wedge) {
  if (!wedge.place.side) {
    return 5;
  }
  if (wedge.directional_margin < kStubby) {
    return 4;
  }
  const double deg = deg_from_rad(wedge.place.turn_rad);
  constexpr std::array<double, 4> kTurns = {0, -90, -45, 45};
  for (std::size_t k = 0; k < kTurns.size(); ++k) {
    if (std::abs(std::remainder(deg - kTurns[k], 360.0)) < (k < 2 ? kKindDeg : 45 - kKindDeg)) {
      return k;
    }
  }
  return 5;
}

std::vector<WedgeProfile> make_profiles(const std::vector<Wedge>& wedges) {
  return profiles_of(wedges, AnglesOf::kAll);
}

std::vector<WedgeProfile> make_read_profiles(const std::vector<Wedge>& wedges) {
  return profiles_of(wedges, AnglesOf::kReadable);
}

std::vector<float> comparable(const std::vector<Wedge>& wedges) {
  std::array<std::vector<double>, kWedgeFeatures.size()> values;
  for (const Wedge& wedge : wedges) {
    const std::vector<float> row = comparable(wedge);
    for (std::size_t f = 0; f < values.size(); ++f) {
      values[f].push_back(row[f]);
    }
  }
  std::vector<float> out;
  for (const std::vector<double>& of_feature : values) {
    if (of_feature.empty()) {
      return {};
    }
    for (const double value : quantiles_of(of_feature)) {
      out.push_back(static_cast<float>(value / static_cast<double>(kProfileQuantiles)));
    }
  }
  return out;
}

}  // namespace dubsar
