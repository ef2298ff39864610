// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/normal_clusters.h"

#include <algorithm>
#include <cmath>

#include "core/units.h"

namespace dubsar {

namespace {

constexpr int kStarts = 8;  // turned by a third of a circle over the number of starts each
constexpr int kRounds = 10;
constexpr double kSame = 0.985;    // cosine of 10 degrees
constexpr float kStray = 0.2929F;  // 1 - cos 45 degrees

using Centres = std::array<Eigen::Vector3f, 3>;

/// One round; returns the cost before it, negative when a cluster is empty.
float improve(std::span<const Eigen::Vector3f> normals, std::span<const float> weights, Centres* centres) {
  Centres sum = {Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()};
  float cost = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    std::size_t best = 0;
    float closest = -2;
    for (std::size_t k = 0; k < 3; ++k) {
      const float c = normals[i].dot((*centres)[k]);
      if (c > closest) {
        closest = c;
        best = k;
      }
    }
    const float away = 1.0F - closest;
    cost += weights[i] * std::min(away, kStray);
    if (away < kStray) {
      sum[best] += weights[i] * normals[i];
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const float length = sum[k].norm();
    if (!(length > 1e-6F)) {
      return -1;
    }
    (*centres)[k] = sum[k] / length;
  }
  return cost;
}

}  // namespace

std::vector<NormalTriple> cluster_normals(std::span<const Eigen::Vector3f> normals,
                                          std::span<const float> weights) {
  struct Found {
    float cost;
    NormalTriple triple;
  };
  std::vector<Found> found;
  for (int start = 0; start < kStarts; ++start) {
    Centres centres;
    for (std::size_t k = 0; k < 3; ++k) {
      const double azimuth =
          2.0 * kPi / 3.0 * (static_cast<double>(k) + static_cast<double>(start) / kStarts);
      const double slope = rad_from_deg(45);
      centres[k] = Eigen::Vector3d(std::sin(slope) * std::cos(azimuth), std::sin(slope) * std::sin(azimuth),
                                   std::cos(slope))
                       .cast<float>();
    }
    float cost = 0;
    for (int round = 0; round < kRounds && cost >= 0; ++round) {
      cost = improve(normals, weights, &centres);
    }
    if (cost < 0) {
      continue;
    }
    std::ranges::sort(centres, [](const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
      return std::atan2(a.y(), a.x()) < std::atan2(b.y(), b.x());
    });
    const Found next{cost, {centres[0].cast<double>(), centres[1].cast<double>(), centres[2].cast<double>()}};
    const bool known = std::ranges::any_of(found, [&](const Found& f) {
      return f.triple[0].dot(next.triple[0]) > kSame && f.triple[1].dot(next.triple[1]) > kSame &&
             f.triple[2].dot(next.triple[2]) > kSame;
    });
    if (!known) {
      found.push_back(next);
    }
  }
  std::ranges::stable_sort(found, {}, &Found::cost);
  std::vector<NormalTriple> triples;
  triples.reserve(found.size());
  for (const Found& f : found) {
    triples.push_back(f.triple);
  }
  return triples;
}

}  // namespace dubsar
