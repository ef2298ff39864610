// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/cell_codes.h"

#include <algorithm>
#include <cmath>

#include "core/wide_clones.h"
#include "core/wide_vec.h"

namespace dubsar {

namespace {

/// Cells that are worked on at a time: what they need lies in the first cache.
constexpr int kBlock = 64;

/// Samples of a row, each quantity by itself, so that the compiler can work on several at once.
struct SampleRow {
  float x[kBlock + 1], y[kBlock + 1], z[kBlock + 1];
  float nx[kBlock + 1], ny[kBlock + 1], nz[kBlock + 1];
  std::int32_t keep[kBlock + 1];

  /// `samples` of them from the array's sample `first` on.
  [[gnu::always_inline]] void fill(const GridSurface& from, std::span<const std::uint8_t> kept,
                                   std::size_t first, int samples) {
    for (int c = 0; c < samples; ++c) {
      const Eigen::Vector3f& p = from.points[first + static_cast<std::size_t>(c)];
      x[c] = p.x();
      y[c] = p.y();
      z[c] = p.z();
    }
    fill_rest(from.normals, kept, first, samples);
  }
  [[gnu::always_inline]] void fill(const GridSamples& from, std::span<const std::uint8_t> kept,
                                   std::size_t first, int samples) {
    for (int c = 0; c < samples; ++c) {
      const std::size_t i = first + static_cast<std::size_t>(c);
      x[c] = from.grid->x[i];
      y[c] = from.grid->y[i];
      z[c] = from.grid->z[i];
    }
    fill_rest(from.normals, kept, first, samples);
  }

 private:
  [[gnu::always_inline]] void fill_rest(std::span<const Eigen::Vector3f> normals,
                                        std::span<const std::uint8_t> kept, std::size_t first, int samples) {
    for (int c = 0; c < samples; ++c) {
      const std::size_t i = first + static_cast<std::size_t>(c);
      nx[c] = normals[i].x();
      ny[c] = normals[i].y();
      nz[c] = normals[i].z();
      keep[c] = kept[i] != 0 ? 1 : 0;
    }
  }
};

using wide::larger;
using wide::Vec;

[[gnu::always_inline]] inline Vec step(const SampleRow& from, int a, const SampleRow& to, int b) {
  return {to.x[b] - from.x[a], to.y[b] - from.y[a], to.z[b] - from.z[a]};
}

/// The triangle with edges ab and ac, squared lengths given; 1 where it passes.
[[gnu::always_inline]] inline std::int32_t passes(const TriangleTest& test, const Vec& ab, const Vec& ac,
                                                  float ab2, float bc2, float ca2, const Vec& to_camera,
                                                  float to_camera2) {
  const float longest2 = larger(larger(ab2, bc2), ca2);
  const Vec n = cross(ab, ac);
  const float n2 = dot(n, n);
  const float facing = test.sign * dot(n, to_camera);
  return static_cast<std::int32_t>(longest2 <= test.max_edge2) &
         static_cast<std::int32_t>(n2 > test.min_shape2 * longest2 * longest2) &
         static_cast<std::int32_t>(facing > 0) &
         static_cast<std::int32_t>(facing * facing > test.min_facing2 * n2 * to_camera2);
}

/// Which diagonal keeps the ridge: 1 for 01-10. Gradients are compared by normals: the change of gradient
/// along a diagonal grows with the angle between the normals at its ends.
[[gnu::always_inline]] inline std::int32_t prefers_antidiagonal(float along_main, float along_anti,
                                                                float main2, float anti2) {
  // Below this the two agree to within rounding, and the shorter one makes the better triangles.
  constexpr float kTie = 1e-6F;
  const bool differ = std::abs(along_main - along_anti) > kTie;
  return differ ? static_cast<std::int32_t>(along_anti > along_main)
                : static_cast<std::int32_t>(anti2 < main2);
}

[[gnu::always_inline]] inline Vec normal(const SampleRow& row, int c) {
  return {row.nx[c], row.ny[c], row.nz[c]};
}

[[gnu::always_inline]] inline std::int32_t cell_code(const SampleRow& upper, const SampleRow& lower, int c,
                                                     const Vec& camera, float camera_known,
                                                     const TriangleTest& test) {
  const std::int32_t k00 = upper.keep[c], k01 = upper.keep[c + 1];
  const std::int32_t k10 = lower.keep[c], k11 = lower.keep[c + 1];
  const Vec p = {k00 != 0 ? upper.x[c] : lower.x[c + 1], k00 != 0 ? upper.y[c] : lower.y[c + 1],
                 k00 != 0 ? upper.z[c] : lower.z[c + 1]};
  const Vec to_camera = {camera.x - camera_known * p.x, camera.y - camera_known * p.y,
                         camera.z - camera_known * p.z};
  const float to_camera2 = dot(to_camera, to_camera);
  const Vec top = step(upper, c, upper, c + 1), bottom = step(lower, c, lower, c + 1);
  const Vec left = step(upper, c, lower, c), right = step(upper, c + 1, lower, c + 1);
  const Vec main = step(upper, c, lower, c + 1), anti = step(lower, c, upper, c + 1);
  const float top2 = dot(top, top), left2 = dot(left, left);
  const float bottom2 = dot(bottom, bottom), right2 = dot(right, right);
  const float main2 = dot(main, main), anti2 = dot(anti, anti);
  const std::int32_t main_first =
      k00 & k10 & k11 & passes(test, left, main, left2, bottom2, main2, to_camera, to_camera2);
  const std::int32_t main_second =
      k00 & k11 & k01 & passes(test, main, top, main2, right2, top2, to_camera, to_camera2);
  const std::int32_t anti_first =
      k00 & k10 & k01 & passes(test, left, top, left2, anti2, top2, to_camera, to_camera2);
  const std::int32_t anti_second =
      k10 & k11 & k01 & passes(test, bottom, anti, bottom2, right2, anti2, to_camera, to_camera2);
  const float along_main = dot(normal(upper, c), normal(lower, c + 1));
  const float along_anti = dot(normal(upper, c + 1), normal(lower, c));
  const std::int32_t all = k00 & k01 & k10 & k11;
  const std::int32_t by_ridge = prefers_antidiagonal(along_main, along_anti, main2, anti2);
  const std::int32_t prefers_anti = all != 0 ? by_ridge : 1 - (k00 & k11);
  // With three corners one of the two diagonals has a triangle. With four, a whole cell along the other
  // diagonal is better than half a one along the preferred, and half a one better than none.
  const std::int32_t main_any = main_first | main_second, main_both = main_first & main_second;
  const std::int32_t anti_any = anti_first | anti_second, anti_both = anti_first & anti_second;
  const std::int32_t other_than_main = all & (1 - main_both) & (anti_both | (1 - main_any));
  const std::int32_t other_than_anti = all & (1 - anti_both) & (main_both | (1 - anti_any));
  const std::int32_t takes_anti = prefers_anti != 0 ? 1 - other_than_anti : other_than_main;
  const std::int32_t main_code = kCellFirst * main_first + kCellSecond * main_second;
  const std::int32_t anti_code =
      kCellFirst * anti_first + kCellSecond * anti_second + kCellAntidiagonal * anti_any;
  return takes_anti != 0 ? anti_code : main_code;
}

/// Of the cells between the row that `first` begins and the one after it, `cols` on.
template <class Samples>
[[gnu::always_inline]] inline void codes_of(const Samples& samples, std::span<const std::uint8_t> keep,
                                            std::size_t first, int cols, int count, const RowCamera& camera,
                                            const TriangleTest& good, std::uint8_t* out) {
  SampleRow upper, lower;
  std::int32_t codes[kBlock];
  const Vec at = {camera.at().x(), camera.at().y(), camera.at().z()};
  const float known = camera.is_known() ? 1.0F : 0.0F;
  for (int begin = 0; begin < count; begin += kBlock) {
    const int cells = std::min(count - begin, kBlock);
    const std::size_t here = first + static_cast<std::size_t>(begin);
    upper.fill(samples, keep, here, cells + 1);
    lower.fill(samples, keep, here + static_cast<std::size_t>(cols), cells + 1);
    for (int c = 0; c < cells; ++c) {
      codes[c] = cell_code(upper, lower, c, at, known, good);
    }
    for (int c = 0; c < cells; ++c) {
      out[begin + c] = static_cast<std::uint8_t>(codes[c]);
    }
  }
}

}  // namespace

TriangleTest::TriangleTest(double spacing_mm, bool mirrored, const GridTriangulationOptions& options)
    : max_edge2(
          static_cast<float>(options.max_edge_factor * spacing_mm * (options.max_edge_factor * spacing_mm))),
      min_facing2(static_cast<float>(options.min_facing_cos * options.min_facing_cos)),
      min_shape2(static_cast<float>(options.min_shape * options.min_shape)),
      sign(mirrored ? -1.0F : 1.0F) {}

DUBSAR_WIDE_CLONES void cell_codes(const GridSurface& surface, std::span<const std::uint8_t> keep, int row,
                                   int col, int count, const RowCamera& camera, const TriangleTest& good,
                                   std::uint8_t* out) {
  codes_of(surface, keep, surface.index(row, col), surface.cols, count, camera, good, out);
}

DUBSAR_WIDE_CLONES void cell_codes(const GridSamples& samples, std::span<const std::uint8_t> keep, int row,
                                   const RowCamera& camera, const TriangleTest& good, std::uint8_t* out) {
  const RangeGrid& grid = *samples.grid;
  codes_of(samples, keep, grid.index(row, 0), grid.cols, grid.cols - 1, camera, good, out);
}

}  // namespace dubsar
