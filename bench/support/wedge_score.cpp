// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/wedge_score.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/order_statistics.h"
#include "core/units.h"

namespace dubsar::bench {

namespace {

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return deg_from_rad(std::atan2(a.cross(b).norm(), a.dot(b)));
}

void compare(const Wedge& found, const Wedge& truth, WedgeScore* score) {
  score->depth_point_um.push_back(1000.0 * (found.depth_point_mm - truth.depth_point_mm).norm());
  score->depth_um.push_back(1000.0 * std::abs(found.depth_mm - truth.depth_mm));
  // Both run counter-clockwise; which edge comes first is nobody's business.
  std::size_t best_shift = 0;
  double best = 1e9;
  std::array<double, 3> best_angles{};
  for (std::size_t shift = 0; shift < 3; ++shift) {
    std::array<double, 3> angles{};
    for (std::size_t k = 0; k < 3; ++k) {
      angles[k] = angle_deg(found.exit_points_mm[(k + shift) % 3] - found.depth_point_mm,
                            truth.exit_points_mm[k] - truth.depth_point_mm);
    }
    if (const double sum = angles[0] + angles[1] + angles[2]; sum < best) {
      best = sum;
      best_shift = shift;
      best_angles = angles;
    }
  }
  score->depth_point_sigmas.push_back((found.depth_point_mm - truth.depth_point_mm).norm() /
                                      found.sigma.depth_point_mm);
  score->depth_sigmas.push_back(std::abs(found.depth_mm - truth.depth_mm) / found.sigma.depth_mm);
  score->depth_off_um.push_back(1000.0 * (found.depth_mm - truth.depth_mm));
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t f = (k + best_shift) % 3;
    const double opening_off = found.opening_angles_rad[f] - truth.opening_angles_rad[k];
    const double opening = std::abs(opening_off);
    const double face_angle_off = found.face_angles_rad[f] - truth.face_angles_rad[k];
    const double length = (found.exit_points_surface_mm[f] - found.depth_point_mm).norm();
    const double true_length = (truth.exit_points_mm[k] - truth.depth_point_mm).norm();
    score->edge_deg.push_back(best_angles[k]);
    score->opening_deg.push_back(deg_from_rad(opening));
    score->edge_sigmas.push_back(rad_from_deg(best_angles[k]) / found.sigma.edge_rad[f]);
    score->opening_sigmas.push_back(opening / found.sigma.opening_rad[f]);
    if (std::isfinite(found.sigma.length_mm[f])) {
      score->length_sigmas.push_back(std::abs(length - true_length) / found.sigma.length_mm[f]);
    }
    score->face_angle_sigmas.push_back(std::abs(face_angle_off) / found.sigma.face_angle_rad[f]);
    score->length_off_um.push_back(1000.0 * (length - true_length));
    score->opening_off_deg.push_back(deg_from_rad(opening_off));
    score->face_angle_off_deg.push_back(deg_from_rad(face_angle_off));
  }
  const auto directional = (static_cast<std::size_t>(found.directional_edge) + 3 - best_shift) % 3;
  score->directional_right += directional == static_cast<std::size_t>(truth.directional_edge) ? 1 : 0;
}

template <class T>
void append(std::vector<T>* into, const std::vector<T>& from) {
  into->insert(into->end(), from.begin(), from.end());
}

}  // namespace

double WedgeScore::precision() const {
  return right + false_ones > 0 ? static_cast<double>(right) / (right + false_ones) : 1.0;
}
double WedgeScore::recall() const {
  return right + missed > 0 ? static_cast<double>(right) / (right + missed) : 1.0;
}
double WedgeScore::f1() const {
  const double both = precision() + recall();
  return both > 0 ? 2.0 * precision() * recall() / both : 0.0;
}
void WedgeScore::add(const WedgeScore& other) {
  right += other.right;
  false_ones += other.false_ones;
  missed += other.missed;
  ignored += other.ignored;
  directional_right += other.directional_right;
  append(&depth_point_um, other.depth_point_um);
  append(&depth_um, other.depth_um);
  append(&edge_deg, other.edge_deg);
  append(&opening_deg, other.opening_deg);
  append(&false_confidence, other.false_confidence);
  append(&right_confidence, other.right_confidence);
  append(&depth_point_sigmas, other.depth_point_sigmas);
  append(&depth_sigmas, other.depth_sigmas);
  append(&edge_sigmas, other.edge_sigmas);
  append(&opening_sigmas, other.opening_sigmas);
  append(&length_sigmas, other.length_sigmas);
  append(&face_angle_sigmas, other.face_angle_sigmas);
  append(&depth_off_um, other.depth_off_um);
  append(&length_off_um, other.length_off_um);
  append(&opening_off_deg, other.opening_off_deg);
  append(&face_angle_off_deg, other.face_angle_off_deg);
  fracture.add(other.fracture);
}

void FractureScore::add(const FractureScore& other) {
  right_on += other.right_on;
  false_on += other.false_on;
  right_touching += other.right_touching;
  false_touching += other.false_touching;
  append(&depth_um, other.depth_um);
}

FractureScore score_fractures(const VertexGraph& graph, const std::vector<std::int32_t>& wedge_of,
                              const std::vector<sim::SurfaceKind>& kinds, const std::vector<int>& pair,
                              const std::vector<Wedge>& found, const std::vector<Wedge>& truth,
                              const ScoreOptions& options) {
  std::vector<int> all(pair.size());
  std::vector<int> on(pair.size());
  std::vector<int> touching(pair.size());
  const auto broken = [&](std::size_t v) { return kinds[v] == sim::SurfaceKind::kFracture; };
  for (std::size_t v = 0; v < std::min(wedge_of.size(), kinds.size()); ++v) {
    if (wedge_of[v] >= 0) {
      const auto wedge = static_cast<std::size_t>(wedge_of[v]);
      ++all[wedge];
      on[wedge] += broken(v) ? 1 : 0;
      const auto ring = graph.ring(static_cast<std::uint32_t>(v));
      touching[wedge] += broken(v) || std::ranges::any_of(ring, broken) ? 1 : 0;
    }
  }
  FractureScore score;
  for (std::size_t f = 0; f < pair.size(); ++f) {
    const int touches = touching[f] > 0 ? 1 : 0;
    const int lies = 2 * on[f] > all[f] ? 1 : 0;
    (pair[f] >= 0 ? score.right_touching : score.false_touching) += touches;
    (pair[f] >= 0 ? score.right_on : score.false_on) += lies;
    if (touches > 0 && pair[f] >= 0) {
      const Wedge& true_one = truth[static_cast<std::size_t>(pair[f])];
      if (true_one.intact >= options.least_intact) {
        score.depth_um.push_back(1000.0 * std::abs(found[f].depth_mm - true_one.depth_mm));
      }
    }
  }
  return score;
}

WedgeScore score_wedges(const std::vector<Wedge>& found, const std::vector<Wedge>& truth,
                        const ScoreOptions& options, std::vector<int>* pair) {
  struct Near {
    double distance;
    std::size_t found, truth;
  };
  std::vector<Near> pairs;
  for (std::size_t f = 0; f < found.size(); ++f) {
    for (std::size_t t = 0; t < truth.size(); ++t) {
      const double d = (found[f].depth_point_mm - truth[t].depth_point_mm).norm();
      if (d < options.reach_mm) {
        pairs.push_back({d, f, t});
      }
    }
  }
  std::ranges::sort(pairs, [](const Near& a, const Near& b) {
    return a.distance != b.distance ? a.distance < b.distance
                                    : std::pair(a.found, a.truth) < std::pair(b.found, b.truth);
  });
  std::vector<int> of_found(found.size(), -1);
  std::vector<int> of_truth(truth.size(), -1);
  for (const Near& near : pairs) {
    if (of_found[near.found] < 0 && of_truth[near.truth] < 0) {
      of_found[near.found] = static_cast<int>(near.truth);
      of_truth[near.truth] = static_cast<int>(near.found);
    }
  }
  WedgeScore score;
  for (std::size_t f = 0; f < found.size(); ++f) {
    if (of_found[f] < 0) {
      ++score.false_ones;
      score.false_confidence.push_back(found[f].confidence);
      continue;
    }
    score.right_confidence.push_back(found[f].confidence);
    const Wedge& true_one = truth[static_cast<std::size_t>(of_found[f])];
    if (true_one.intact < options.least_intact) {
      ++score.ignored;
    } else {
      ++score.right;
      compare(found[f], true_one, &score);
    }
  }
  for (std::size_t t = 0; t < truth.size(); ++t) {
    score.missed += of_truth[t] < 0 && truth[t].intact >= options.least_intact ? 1 : 0;
  }
  if (pair != nullptr) {
    *pair = std::move(of_found);
  }
  return score;
}

double median(std::vector<double> values) {
  if (values.empty()) {
    return std::nan("");
  }
  return median_of(std::move(values));
}

}  // namespace dubsar::bench
