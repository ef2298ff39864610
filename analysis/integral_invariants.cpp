// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/integral_invariants.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/buckets.h"
#include "analysis/height_map.h"
#include "core/near_cells.h"
#include "core/parallel.h"
#include "core/random.h"

namespace dubsar {
namespace {

using Eigen::Vector3f;
constexpr std::size_t kGrain = 1U << 10U;
/// The coarsest raster of the largest sphere: pixels to its radius.
constexpr double kPixelsPerRadius = 16;
/// A sphere with fewer pixels to its radius is a few columns of clay.
constexpr double kResolvedPixels = 2.5;
/// Places within a pixel for which the sphere is tabulated, to a side.
constexpr int kSubPixels = 4;
constexpr std::size_t kLanes = 8;
/// Of a disc beside the end of the mesh this share at least must hold clay: a corner of it holds a quarter.
constexpr float kLeastSeen = 0.15F;
/// Faces whose vertices look further away from a map's direction than this (cosine) are not drawn into it:
/// the next direction is never more than 28 degrees away.
constexpr float kDrawn = 0.45F;

/// The 26 directions to the faces, edges and corners of a cube.
std::vector<Vector3f> directions() {
  std::vector<Vector3f> all;
  for (int z = -1; z <= 1; ++z) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        if (x != 0 || y != 0 || z != 0) {
          all.push_back(
              Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)).normalized());
        }
      }
    }
  }
  return all;
}

/// Which direction each vertex reads, and into which each face is drawn.
struct Drawn {
  std::vector<std::uint8_t> nearest;  ///< [V], the count of directions where there is none
  std::vector<std::uint32_t> faces;   ///< [F], a bit a direction
};

Drawn make_drawn(const Mesh& mesh, const std::vector<Vector3f>& outlook, const std::vector<Vector3f>& ways) {
  constexpr std::size_t kWide = 1U << 14U;
  Drawn drawn;
  drawn.nearest.assign(mesh.positions.size(), static_cast<std::uint8_t>(ways.size()));
  drawn.faces.resize(mesh.faces.size());
  std::vector<std::uint32_t> of_vertex(mesh.positions.size(), 0);
  parallel_for_each_index(
      mesh.positions.size(),
      [&](std::size_t v) {
        float most = 0;
        for (std::size_t k = 0; mesh.positions[v].allFinite() && k < ways.size(); ++k) {
          const float along = outlook[v].dot(ways[k]);
          of_vertex[v] |= along >= kDrawn ? 1U << k : 0U;
          if (along > most) {
            most = along;
            drawn.nearest[v] = static_cast<std::uint8_t>(k);
          }
        }
      },
      kWide);
  parallel_for_each_index(
      mesh.faces.size(),
      [&](std::size_t i) {
        const auto& f = mesh.faces[i];
        const auto bits = [&](std::uint32_t v) { return v < of_vertex.size() ? of_vertex[v] : 0U; };
        drawn.faces[i] = bits(f[0]) & bits(f[1]) & bits(f[2]);
      },
      kWide);
  return drawn;
}

/// Half the height of a sphere over the pixels of its disc: what the clay there is clamped to.
struct Disc {
  struct Row {
    int dy = 0;
    int dx = 0;              ///< of the first pixel
    std::size_t begin = 0;   ///< into half_mm
    std::size_t blocks = 0;  ///< of kLanes pixels; filled up with zeros
  };
  std::vector<Row> rows;
  std::vector<float> half_mm;
  float sum_mm = 0;
};

/// The disc of a sphere whose centre lies (fx, fy) pixels off the middle of the pixel.
Disc make_disc(double radius_mm, double pixel_mm, double fx, double fy) {
  Disc disc;
  const int reach = static_cast<int>(std::ceil(radius_mm / pixel_mm)) + 1;
  double sum = 0;
  for (int dy = -reach; dy <= reach; ++dy) {
    std::vector<float> row;
    int first = 0;
    for (int dx = -reach; dx <= reach; ++dx) {
      // The mean over the pixel, by parts, so that small spheres are not a few lucky pixels.
      constexpr int kParts = 4;
      double half = 0;
      for (int j = 0; j < kParts; ++j) {
        for (int i = 0; i < kParts; ++i) {
          const double x = pixel_mm * (dx - fx + (i + 0.5) / kParts - 0.5);
          const double y = pixel_mm * (dy - fy + (j + 0.5) / kParts - 0.5);
          half += std::sqrt(std::max(0.0, radius_mm * radius_mm - x * x - y * y));
        }
      }
      half /= kParts * kParts;
      if (half > 0 && row.empty()) {
        first = dx;
      }
      if (half > 0 || !row.empty()) {
        row.push_back(static_cast<float>(half));
        sum += half;
      }
    }
    while (!row.empty() && row.back() == 0) {
      row.pop_back();
    }
    if (row.empty()) {
      continue;
    }
    row.resize((row.size() + kLanes - 1) / kLanes * kLanes, 0.0F);
    disc.rows.push_back({dy, first, disc.half_mm.size(), row.size() / kLanes});
    disc.half_mm.insert(disc.half_mm.end(), row.begin(), row.end());
  }
  disc.sum_mm = static_cast<float>(sum);
  return disc;
}

/// Σ clamp(h − z, ±half) over the disc about the pixel `middle` points at.
float clamped_sum(const Disc& disc, const float* middle, std::ptrdiff_t row_step, float z) {
  std::array<float, kLanes> sums{};
  for (const Disc::Row& row : disc.rows) {
    const float* h = middle + row.dy * row_step + row.dx;
    const float* half = &disc.half_mm[row.begin];
    for (std::size_t block = 0; block < row.blocks; ++block, h += kLanes, half += kLanes) {
      for (std::size_t k = 0; k < kLanes; ++k) {
        const float low = -half[k];
        float v = h[k] - z;
        v = v < low ? low : v;
        v = v > half[k] ? half[k] : v;
        sums[k] += v;
      }
    }
  }
  return ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
}

/// How a plane through the middle of a disc rises, mm a pixel, and where the middle lies, pixels from that of
/// its pixel.
struct Tilt {
  float x_mm = 0, y_mm = 0;
  float middle_x_px = 0, middle_y_px = 0;
};

/// clamped_sum() less that of the plane, over the sum of what it is clamped to, of the pixels that hold clay
/// alone: over a whole disc the plane's is none. 0 where these are too little of the disc to tell.
float mean_over_clay(const Disc& disc, const float* middle, std::ptrdiff_t row_step, float z,
                     const Tilt& tilt) {
  float sum = 0;
  float seen = 0;
  for (const Disc::Row& row : disc.rows) {
    const float* const h = middle + row.dy * row_step + row.dx;
    const float* const half = &disc.half_mm[row.begin];
    const float row_rise = tilt.y_mm * (static_cast<float>(row.dy) - tilt.middle_y_px);
    for (std::size_t k = 0; k < row.blocks * kLanes; ++k) {
      if (std::isfinite(h[k])) {
        const float dx = static_cast<float>(row.dx) + static_cast<float>(k) - tilt.middle_x_px;
        sum += std::clamp(h[k] - z, -half[k], half[k]) -
               std::clamp(row_rise + tilt.x_mm * dx, -half[k], half[k]);
        seen += half[k];
      }
    }
  }
  return seen > kLeastSeen * disc.sum_mm ? std::clamp(sum / seen, -1.0F, 1.0F) : 0.0F;
}

/// Of every vertex how far the nearest end of the mesh is, up to reach_mm. [V]
std::vector<float> border_distances(const Mesh& mesh, double reach_mm) {
  // Around a vertex inside each neighbour belongs to two faces, whichever way these run.
  std::vector<std::uint64_t> odd(mesh.positions.size(), 0);
  for (const auto& f : mesh.faces) {
    if (std::ranges::any_of(f, [&](std::uint32_t v) { return v >= odd.size(); })) {
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      odd[f[k]] ^= seed_for(0, f[(k + 1) % 3]) ^ seed_for(0, f[(k + 2) % 3]);
    }
  }
  NearCells ends(reach_mm);
  for (std::size_t v = 0; v < odd.size(); ++v) {
    if (odd[v] != 0 && mesh.positions[v].allFinite()) {
      ends.add(mesh.positions[v].cast<double>(), v);
    }
  }
  std::vector<float> distance(odd.size(), static_cast<float>(reach_mm));
  parallel_for_each_index(
      distance.size(),
      [&](std::size_t v) {
        if (!mesh.positions[v].allFinite()) {
          return;
        }
        float least = distance[v] * distance[v];
        for (const std::size_t end : ends.about(mesh.positions[v].cast<double>())) {
          least = std::min(least, (mesh.positions[end] - mesh.positions[v]).squaredNorm());
        }
        distance[v] = std::sqrt(least);
      },
      kGrain);
  return distance;
}

/// Discs of all scales for all places within a pixel: [place][scale].
class Discs {
 public:
  Discs(const std::vector<float>& radii_mm, double pixel_mm) : scales_(radii_mm.size()) {
    discs_.resize(static_cast<std::size_t>(kSubPixels) * kSubPixels * scales_);
    parallel_for_each_index(
        discs_.size(),
        [&](std::size_t i) {
          const auto place = static_cast<int>(i / scales_);
          const int row = place / kSubPixels;
          discs_[i] =
              make_disc(radii_mm[i % scales_], pixel_mm, (place % kSubPixels + 0.5) / kSubPixels - 0.5,
                        (row + 0.5) / kSubPixels - 0.5);
        },
        1);
  }
  struct Place {
    const Disc* by_scale;
    float past_x_px, past_y_px;  ///< from the tabulated place to the true one
  };
  /// fx and fy in [−½, ½)
  [[nodiscard]] Place at(float fx, float fy) const {
    const auto sub = [](float f) {
      return std::clamp(static_cast<int>((f + 0.5F) * kSubPixels), 0, kSubPixels - 1);
    };
    const auto middle = [](int k) { return (static_cast<float>(k) + 0.5F) / kSubPixels - 0.5F; };
    const int x = sub(fx);
    const int y = sub(fy);
    return {&discs_[static_cast<std::size_t>(y * kSubPixels + x) * scales_], fx - middle(x), fy - middle(y)};
  }

 private:
  std::size_t scales_;
  std::vector<Disc> discs_;
};

}  // namespace

IntegralInvariants integral_invariants(const Mesh& mesh, const std::vector<Vector3f>& outlook,
                                       double mean_edge_mm, const IntegralInvariantOptions& options,
                                       const JobContext& job) {
  IntegralInvariants result;
  const std::size_t scales = std::size_t{1} << static_cast<unsigned>(std::clamp(options.octave, 0, 5));
  for (std::size_t i = 0; i < scales; ++i) {
    result.radii_mm.push_back(
        static_cast<float>(options.radius_mm * (1.0 - static_cast<double>(i) / static_cast<double>(scales))));
  }
  result.value.assign(mesh.positions.size() * scales, 0.0F);
  const double pixel_mm = std::max(options.radius_mm / kPixelsPerRadius, mean_edge_mm);
  result.resolved_mm = kResolvedPixels * pixel_mm;
  const Discs discs(result.radii_mm, pixel_mm);
  const int margin = static_cast<int>(std::ceil(options.radius_mm / pixel_mm)) + 2 + static_cast<int>(kLanes);

  // The pixel at the end of the mesh may be empty although clay begins in it.
  const auto beside_mm = static_cast<float>(2 * pixel_mm);
  const std::vector<float> border_mm = border_distances(mesh, options.radius_mm + 2.5 * pixel_mm);

  const std::vector<Vector3f> ways = directions();
  const Drawn drawn = make_drawn(mesh, outlook, ways);
  const Buckets by_way =
      make_buckets(mesh.positions.size(), ways.size(), [&](std::size_t v) { return drawn.nearest[v]; });
  for (std::size_t k = 0; k < ways.size(); ++k) {
    if (job.cancelled()) {
      return {};
    }
    job.progress("integral invariants", static_cast<double>(k) / static_cast<double>(ways.size()));
    if (by_way.start[k] == by_way.start[k + 1]) {
      continue;
    }
    const Buckets faces = make_buckets(mesh.faces.size(), 1, [&](std::size_t f) -> std::size_t {
      return (drawn.faces[f] >> k & 1U) != 0 ? 0 : 1;
    });
    if (faces.start[1] == 0) {
      continue;
    }
    const HeightMap map(mesh, {&faces.item[0], faces.start[1]}, ways[k], static_cast<float>(pixel_mm),
                        margin);
    parallel_for_each_index(
        by_way.start[k + 1] - by_way.start[k],
        [&](std::size_t i) {
          const std::uint32_t v = by_way.item[by_way.start[k] + i];
          const Vector3f at = map.place(mesh.positions[v]);
          if (!map.holds(at)) {
            return;
          }
          const float x = std::round(at.x());
          const float y = std::round(at.y());
          const Discs::Place disc = discs.at(at.x() - x, at.y() - y);
          const float z = at.z() - map.rise_mm(outlook[v], disc.past_x_px, disc.past_y_px);
          const float* const middle = map.row(static_cast<int>(y)) + static_cast<int>(x);
          const Tilt tilt{map.rise_mm(outlook[v], 1, 0), map.rise_mm(outlook[v], 0, 1),
                          at.x() - x - disc.past_x_px, at.y() - y - disc.past_y_px};
          for (std::size_t s = 0; s < scales; ++s) {
            const Disc& at_scale = disc.by_scale[s];
            result.value[v * scales + s] =
                border_mm[v] < result.radii_mm[s] + beside_mm
                    ? mean_over_clay(at_scale, middle, map.row_step(), z, tilt)
                    : clamped_sum(at_scale, middle, map.row_step(), z) / at_scale.sum_mm;
          }
        },
        kGrain);
  }
  return result;
}

std::vector<float> strongest_response(const IntegralInvariants& invariants) {
  const std::size_t scales = invariants.radii_mm.size();
  std::vector<float> strongest(scales == 0 ? 0 : invariants.value.size() / scales);
  // The largest first.
  const auto resolved = static_cast<std::size_t>(
      std::count_if(invariants.radii_mm.begin(), invariants.radii_mm.end(),
                    [&](float r) { return static_cast<double>(r) >= invariants.resolved_mm; }));
  const std::size_t taken = std::max<std::size_t>(1, resolved);
  parallel_for_each_index(strongest.size(), [&](std::size_t v) {
    const float* const f = &invariants.value[v * scales];
    strongest[v] =
        *std::max_element(f, f + taken, [](float a, float b) { return std::abs(a) < std::abs(b); });
  });
  return strongest;
}

}  // namespace dubsar
