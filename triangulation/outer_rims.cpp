// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/outer_rims.h"

#include <Eigen/Core>

namespace dubsar {

namespace {

using Eigen::Vector3f;

/// A shorter rim has fewer faces inside than a piece that stays (StitchOptions::least_component_faces).
constexpr std::size_t kLeastEdges = 14;
/// cos; a crack has hardly an area, and that looks anywhere.
constexpr float kSurelyOutside = 0.5F;
/// Faces for each µ² inside: two in a grid, and more where it is inclined. Around an opening there are more
/// in the six µ that are looked at.
constexpr float kMostFaces = 3.0F;

}  // namespace

void OuterRims::gather_pieces() {
  pieces_.emplace(sheet_->positions.size());
  for (const Triangle& f : sheet_->faces) {
    pieces_->unite(f[0], f[1]);
    pieces_->unite(f[0], f[2]);
  }
  faces_.assign(sheet_->positions.size(), 0);
  for (const Triangle& f : sheet_->faces) {
    ++faces_[pieces_->root(f[0])];
  }
}

bool OuterRims::contain(const std::vector<std::uint32_t>& walk) {
  if (walk.size() < kLeastEdges) {
    return false;
  }
  // Faces lie to the left of a walk: seen from outside the clay it goes round an opening clockwise.
  const Vector3f& first = sheet_->positions[walk.front()];
  Vector3f area = Vector3f::Zero();
  Vector3f normal = Vector3f::Zero();
  float spacing_mm = 0;
  for (std::size_t i = 0; i < walk.size(); ++i) {
    const Vector3f& here = sheet_->positions[walk[i]];
    const Vector3f& next = sheet_->positions[walk[(i + 1) % walk.size()]];
    area += 0.5F * (here - first).cross(next - first);
    normal += sheet_->normals[walk[i]];
    spacing_mm += sheet_->spacing_mm[walk[i]] / static_cast<float>(walk.size());
  }
  if (!(area.dot(normal) > kSurelyOutside * area.norm() * normal.norm())) {
    return false;
  }
  if (!pieces_) {
    gather_pieces();
  }
  const auto faces = static_cast<float>(faces_[pieces_->root(walk.front())]);
  return faces <= kMostFaces * area.norm() / (spacing_mm * spacing_mm);
}

}  // namespace dubsar
