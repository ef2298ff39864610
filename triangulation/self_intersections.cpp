// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/self_intersections.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "triangulation/crowded_vertices.h"
#include "triangulation/face_cells.h"
#include "triangulation/face_cut.h"
#include "triangulation/part_cells.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;
using Positions = std::span<const Vector3f>;
constexpr std::uint32_t kNoFace = 0xffffffffU;
using Face = std::array<std::uint32_t, 3>;

/// Without area and without an inside: nothing cuts it.
bool is_point(const Face& f) {
  return f[0] == f[1] && f[1] == f[2];
}

bool is_sound(Positions positions, const Face& f) {
  return std::all_of(f.begin(), f.end(),
                     [&](std::uint32_t v) { return v < positions.size() && positions[v].allFinite(); });
}

/// How many faces are how large: of the sizes above 0, by their power of two.
class Sizes {
 public:
  void add(float size_mm) { ++count_[std::bit_cast<std::uint32_t>(size_mm) >> kMantissaBits]; }
  void add(const Sizes& other) {
    for (std::size_t k = 0; k < count_.size(); ++k) {
      count_[k] += other.count_[k];
    }
  }
  /// A size that so many faces, or a few more, are below: up to twice the one that they are just below.
  [[nodiscard]] double above(std::size_t faces) const {
    std::size_t below = 0;
    std::size_t power = 1;  // the first holds those too small for their power
    while (power + 1 < count_.size() && (below += count_[power]) <= faces) {
      ++power;
    }
    return std::ldexp(1.0, static_cast<int>(power) - 126);
  }

 private:
  static constexpr unsigned kMantissaBits = 23;
  std::array<std::uint32_t, 256> count_{};
};

/// What cells are to be made for: the mean size of the faces, unless a few that are huge make that far more
/// than most are. Then a size that hardly any are below, as larger ones have coarser cells.
double size_to_sort_by(const Sizes& sizes, std::size_t count, double mean_mm) {
  constexpr double kFarAboveHalf = 4.0;
  constexpr double kFarAboveLeast = 16.0;
  constexpr std::size_t kHardlyAny = 256;   // one of so many
  constexpr std::size_t kMostOfOne = 4096;  // and no more, as they may all lie in one cell
  const double least_mm = sizes.above(std::min(count / kHardlyAny, kMostOfOne));
  return mean_mm > kFarAboveHalf * sizes.above(count / 2) || mean_mm > kFarAboveLeast * least_mm
             ? std::min(least_mm, mean_mm)
             : mean_mm;
}

/// Of the sound faces.
struct Extent {
  Eigen::AlignedBox3f box;
  double sizes_mm = 0;  ///< their sum
  double largest_mm = 0;
  Sizes by_power;
  std::size_t count = 0;
  std::size_t unsound = 0;

  void add(const Eigen::AlignedBox3f& face) {
    const double size_mm = (face.max().cast<double>() - face.min().cast<double>()).maxCoeff();
    box.extend(face);
    sizes_mm += size_mm;
    largest_mm = std::max(largest_mm, size_mm);
    by_power.add(static_cast<float>(size_mm));
    ++count;
  }
  void add(const Extent& other) {
    box.extend(other.box);
    sizes_mm += other.sizes_mm;
    largest_mm = std::max(largest_mm, other.largest_mm);
    by_power.add(other.by_power);
    count += other.count;
    unsound += other.unsound;
  }
};

Extent extent_of(Positions positions, std::span<const Face> faces, const JobContext& job) {
  return parallel_reduce_ordered(
      faces.size(), 65536, Extent{},
      [&](std::size_t begin, std::size_t end) {
        Extent part;
        for (std::size_t i = begin; i < end && !job.cancelled(); ++i) {
          if (is_point(faces[i])) {
            continue;
          }
          if (is_sound(positions, faces[i])) {
            part.add(box_of(positions, faces[i]));
          } else {
            ++part.unsound;
          }
        }
        return part;
      },
      [](Extent& total, const Extent& part) { total.add(part); });
}

/// Those that may cut another.
std::vector<std::uint32_t> faces_to_search(Positions positions, std::span<const Face> faces,
                                           std::span<const std::uint32_t> part_of_face, const Extent& extent,
                                           double mean_mm, const JobContext& job) {
  constexpr double kCellOfMean = 3.0;
  constexpr double kMostOfMean = 100.0;  // one huge face would fill all cells
  std::vector<std::uint32_t> out;
  if (!part_of_face.empty() && extent.unsound == 0 && extent.largest_mm < kMostOfMean * mean_mm) {
    out = faces_at_stake(positions, faces, part_of_face, extent.box,
                         static_cast<float>(kCellOfMean * mean_mm), job);
    std::erase_if(out, [&](std::uint32_t f) { return is_point(faces[f]); });
    return out;
  }
  for (std::uint32_t i = 0; i < faces.size() && !job.cancelled(); ++i) {
    if (!is_point(faces[i]) && is_sound(positions, faces[i])) {
      out.push_back(i);
    }
  }
  return out;
}

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> self_intersections(
    std::span<const Vector3f> positions, std::span<const Face> all_faces,
    std::span<const std::uint32_t> part_of_face, const JobContext& job, const CountWork& counted) {
  const Extent extent = extent_of(positions, all_faces, job);
  if (extent.count < 2 || !(extent.sizes_mm > 0) || job.cancelled()) {
    return {};
  }
  const double mean_mm = extent.sizes_mm / static_cast<double>(extent.count);
  std::vector<std::uint32_t> faces =
      faces_to_search(positions, all_faces, part_of_face, extent, mean_mm, job);
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  Pairs out = part_of_face.empty() ? take_cuts_at_crowded_vertices(positions, all_faces, faces, job, counted)
                                   : Pairs{};
  if (job.cancelled()) {
    return out;
  }
  constexpr double kCellOfSize = 2.5;
  const double smallest_mm = std::max(kCellOfSize * size_to_sort_by(extent.by_power, extent.count, mean_mm),
                                      static_cast<double>(std::numeric_limits<float>::min()));
  const FaceCells cells(positions, all_faces, faces, part_of_face, smallest_mm, job);
  const Pairs elsewhere = parallel_reduce_ordered(
      cells.size(), 256, Pairs{},
      [&](std::size_t begin, std::size_t end) {
        Pairs found;
        std::vector<std::uint32_t> beside;
        std::uint32_t of_plane = kNoFace;
        FacePlane plane;
        for (std::size_t cell = begin; cell < end && !job.cancelled(); ++cell) {
          cells.for_each_touching(cell, beside, job, counted, [&](std::uint32_t a, std::uint32_t b) {
            if (a != of_plane) {
              plane = FacePlane(positions, all_faces[a]);
              of_plane = a;
            }
            if (faces_cut(positions, all_faces[a], plane, all_faces[b])) {
              found.push_back(std::minmax(a, b));
            }
          });
        }
        return found;
      },
      [](Pairs& total, const Pairs& part) { total.insert(total.end(), part.begin(), part.end()); });
  out.insert(out.end(), elsewhere.begin(), elsewhere.end());
  if (!job.cancelled()) {
    std::sort(out.begin(), out.end());
  }
  return out;
}

}  // namespace dubsar
