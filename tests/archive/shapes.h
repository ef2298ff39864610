// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cmath>

#include "archive/image.h"
#include "core/mesh.h"
#include "core/red_map.h"

namespace dubsar {

inline constexpr std::array<Rgb8, kFaceCount> kFaceColours = {
    {{220, 40, 40}, {40, 200, 40}, {40, 60, 230}, {230, 220, 40}, {220, 40, 220}, {40, 220, 220}}};
inline constexpr Rgb8 kMarkColour{0, 0, 0};

inline void add_quad(Mesh& mesh, const std::array<Eigen::Vector3f, 4>& corners, Rgb8 colour) {
  const auto base = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Eigen::Vector3f& p : corners) {
    mesh.positions.push_back(p);
    mesh.colours.push_back(colour);
  }
  mesh.faces.push_back({base, base + 1, base + 2});
  mesh.faces.push_back({base, base + 2, base + 3});
}

/// A box with a colour for each face (by Face) and a black mark near the corner (+x, +y) of the obverse and
/// near the corner (+x, -y) of the reverse. x across, y to the top edge, z out of the obverse.
inline Mesh coloured_box(float x, float y, float z, float cx = 0, float cy = 0, float cz = 0) {
  const float a = x / 2, b = y / 2, c = z / 2;
  Mesh mesh;
  const auto colour = [](Face face) { return kFaceColours[static_cast<std::size_t>(face)]; };
  add_quad(mesh, {{{-a, -b, c}, {a, -b, c}, {a, b, c}, {-a, b, c}}}, colour(Face::kObverse));
  add_quad(mesh, {{{-a, b, -c}, {a, b, -c}, {a, -b, -c}, {-a, -b, -c}}}, colour(Face::kReverse));
  add_quad(mesh, {{{-a, -b, -c}, {-a, -b, c}, {-a, b, c}, {-a, b, -c}}}, colour(Face::kLeft));
  add_quad(mesh, {{{a, -b, c}, {a, -b, -c}, {a, b, -c}, {a, b, c}}}, colour(Face::kRight));
  add_quad(mesh, {{{-a, b, c}, {a, b, c}, {a, b, -c}, {-a, b, -c}}}, colour(Face::kTop));
  add_quad(mesh, {{{-a, -b, -c}, {a, -b, -c}, {a, -b, c}, {-a, -b, c}}}, colour(Face::kBottom));
  const float m = 0.25F, e = 1e-3F;
  add_quad(mesh, {{{a * m, b * m, c + e}, {a, b * m, c + e}, {a, b, c + e}, {a * m, b, c + e}}}, kMarkColour);
  add_quad(mesh, {{{a * m, -b * m, -c - e}, {a, -b * m, -c - e}, {a, -b, -c - e}, {a * m, -b, -c - e}}},
           kMarkColour);
  for (Eigen::Vector3f& p : mesh.positions) {
    p += Eigen::Vector3f(cx, cy, cz);
  }
  return mesh;
}

/// The hue of a lit pixel: which of the face colours it is nearest to after its brightness is taken out.
inline int nearest_face_colour(Rgb8 seen) {
  const auto direction = [](Rgb8 c) {
    const Eigen::Vector3d v(c[0] + 1.0, c[1] + 1.0, c[2] + 1.0);
    return Eigen::Vector3d(v.normalized());
  };
  int best = 0;
  for (int f = 1; f < kFaceCount; ++f) {
    if (direction(seen).dot(direction(kFaceColours[static_cast<std::size_t>(f)])) >
        direction(seen).dot(direction(kFaceColours[static_cast<std::size_t>(best)]))) {
      best = f;
    }
  }
  return best;
}

/// An open sheet of n × n cells of z = height(x, y) over [-size/2, size/2]², seen from +z.
template <class Height>
Mesh height_sheet(int n, float size, const Height& height) {
  Mesh mesh;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const float x = size * (static_cast<float>(i) / static_cast<float>(n) - 0.5F);
      const float y = size * (static_cast<float>(j) / static_cast<float>(n) - 0.5F);
      mesh.positions.emplace_back(x, y, height(x, y));
    }
  }
  const auto at = [n](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      mesh.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

}  // namespace dubsar
