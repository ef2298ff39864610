// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/scan_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "core/grid_geometry.h"
#include "core/grid_noise.h"
#include "core/parallel.h"
#include "registration/narrow_gaps.h"
#include "registration/surface_samples.h"

namespace dubsar {

namespace {

/// Neighbours farther apart than this many spacings are on two sheets.
constexpr float kStepFactor = 5.0F;
/// A block that holds less than this share of its samples, those missing in narrow gaps counted, lies at a
/// border or a drop-out.
constexpr double kLeastBlockShare = 0.7;
/// How long a narrow gap must be, in parts of the scale: longer than what a wedge hides.
constexpr double kShortestGap = 0.15;
/// A raster cell of this many spacings seldom stays empty on a slope or a warped grid.
constexpr double kRasterCell = 1.5;

/// The cells of a block of stride × stride from its middle outwards: (row, column), of equal ones the first.
std::vector<std::pair<int, int>> from_the_middle(int stride) {
  std::vector<std::pair<int, int>> cells;
  for (int dr = 0; dr < stride; ++dr) {
    for (int dc = 0; dc < stride; ++dc) {
      cells.emplace_back(dr, dc);
    }
  }
  const auto away = [stride](const std::pair<int, int>& cell) {
    return std::abs(2 * cell.first - stride + 1) + std::abs(2 * cell.second - stride + 1);
  };
  std::stable_sort(cells.begin(), cells.end(),
                   [&](const auto& a, const auto& b) { return away(a) < away(b); });
  return cells;
}

/// The samples of a scan that are entered.
struct Entered {
  const RangeGrid& grid;
  double spacing_mm = 0;
  std::vector<std::uint8_t> keep;
  std::vector<std::uint8_t> gaps;  ///< narrow_gaps()
};

/// Which blocks are complete, and which of the empty ones are so because of a narrow gap (empty: none).
struct Blocks {
  std::vector<std::uint8_t> full, hollow;
};

/// Decimates by averaging blocks of stride × stride samples that lie on the sheet of the block's middle
/// sample.
RangeGrid averaged(const Entered& entered, int stride, Blocks& blocks) {
  const auto& [grid, spacing_mm, keep, gaps] = entered;
  RangeGrid out;
  out.allocate((grid.rows + stride - 1) / stride, (grid.cols + stride - 1) / stride);
  out.spacing_mm = spacing_mm * stride;
  out.view = grid.view;
  out.view.motion_per_row_mm *= stride;
  blocks.full.assign(out.size(), 0);
  blocks.hollow.assign(gaps.empty() ? 0 : out.size(), 0);
  const double least = kLeastBlockShare * stride * stride;
  const float reach2 =
      std::pow(kStepFactor * 0.5F * static_cast<float>(spacing_mm) * static_cast<float>(stride), 2.0F);
  const std::vector<std::pair<int, int>> order = from_the_middle(stride);
  parallel_for_each_index(
      static_cast<std::size_t>(out.rows),
      [&](std::size_t r) {
        const int row = static_cast<int>(r);
        for (int col = 0; col < out.cols; ++col) {
          const int rows_in = std::min(stride, grid.rows - row * stride);
          const int cols_in = std::min(stride, grid.cols - col * stride);
          const std::size_t corner = grid.index(row * stride, col * stride);
          const auto place = [&](int dr, int dc) {
            return corner + static_cast<std::size_t>(dr) * static_cast<std::size_t>(grid.cols) +
                   static_cast<std::size_t>(dc);
          };
          const auto middle = std::find_if(order.begin(), order.end(), [&](const auto& cell) {
            return cell.first < rows_in && cell.second < cols_in && keep[place(cell.first, cell.second)] != 0;
          });
          const std::size_t to = out.index(row, col);
          int missing = 0;
          for (int dr = 0; dr < rows_in && !gaps.empty(); ++dr) {
            for (int dc = 0; dc < cols_in; ++dc) {
              missing += gaps[place(dr, dc)];
            }
          }
          if (middle == order.end()) {
            if (missing >= least) {
              blocks.hollow[to] = 1;
            }
            continue;
          }
          const Eigen::Vector3f base = grid.point(place(middle->first, middle->second));
          Eigen::Vector3f sum = Eigen::Vector3f::Zero();
          int count = 0;
          for (int dr = 0; dr < rows_in; ++dr) {
            for (int dc = 0; dc < cols_in; ++dc) {
              const std::size_t i = place(dr, dc);
              if (keep[i] == 0) {
                continue;
              }
              const Eigen::Vector3f d = grid.point(i) - base;
              if (d.squaredNorm() <= reach2) {
                sum += d;
                ++count;
              }
            }
          }
          const Eigen::Vector3f p = base + sum / static_cast<float>(count);
          out.x[to] = p.x();
          out.y[to] = p.y();
          out.z[to] = p.z();
          out.valid[to] = 1;
          blocks.full[to] = count + missing >= least ? 1 : 0;
        }
      },
      8);
  return out;
}

/// Mean of the normals over the 3×3 neighbours on the same sheet.
std::vector<Eigen::Vector3f> smoothed_normals(const RangeGrid& grid,
                                              const std::vector<Eigen::Vector3f>& normals) {
  std::vector<Eigen::Vector3f> out(normals.size(), Eigen::Vector3f::Zero());
  const float step2 = std::pow(kStepFactor * static_cast<float>(grid.spacing_mm), 2.0F);
  parallel_for_each_index(
      static_cast<std::size_t>(grid.rows),
      [&](std::size_t r) {
        const int row = static_cast<int>(r);
        for (int col = 0; col < grid.cols; ++col) {
          const std::size_t i = grid.index(row, col);
          if (grid.valid[i] == 0 || normals[i].isZero()) {
            continue;
          }
          Eigen::Vector3f sum = Eigen::Vector3f::Zero();
          for (int dr = -1; dr <= 1; ++dr) {
            for (int dc = -1; dc <= 1; ++dc) {
              if (grid.is_valid(row + dr, col + dc)) {
                const std::size_t j = grid.index(row + dr, col + dc);
                if ((grid.point(j) - grid.point(i)).squaredNorm() <= step2) {
                  sum += normals[j];
                }
              }
            }
          }
          const float length = sum.norm();
          out[i] = length > 1e-6F ? Eigen::Vector3f(sum / length) : normals[i];
        }
      },
      8);
  return out;
}

/// Runs tasks that write to places of their own.
template <class... Tasks>
void side_by_side(const Tasks&... tasks) {
  const std::array<std::function<void()>, sizeof...(Tasks)> all{tasks...};
  parallel_for_each_index(
      all.size(), [&](std::size_t k) { all[k](); }, 1);
}

std::unique_ptr<SurfaceLevel> make_level(const Entered& entered, int stride, int points,
                                         const ScanSurfaceOptions& options) {
  auto level = std::make_unique<SurfaceLevel>();
  Blocks blocks;
  level->grid = averaged(entered, stride, blocks);
  level->spacing_mm = level->grid.spacing_mm;
  GridGeometry geometry = grid_geometry(level->grid, static_cast<double>(kStepFactor));
  level->normals = smoothed_normals(level->grid, geometry.normals);
  if (!blocks.hollow.empty()) {
    bridge_gaps(level->grid, blocks.hollow, static_cast<double>(kStepFactor) * level->spacing_mm,
                geometry.boundary);
  }
  level->usable.assign(level->grid.size(), 0);
  for (std::size_t i = 0; i < level->grid.size(); ++i) {
    level->usable[i] = level->grid.valid[i] != 0 && blocks.full[i] != 0 && geometry.boundary[i] == 0 &&
                               !level->normals[i].isZero()
                           ? 1
                           : 0;
  }
  side_by_side([&] { level->lookup = std::make_unique<GridLookup>(level->grid, level->usable); },
               [&] { level->raster = DepthRaster(level->grid, kRasterCell * level->spacing_mm); },
               [&] { choose_samples(*level, points, options); });
  return level;
}

/// Mean intensity of the kept samples of each block of stride × stride; empty when the grid has none.
std::vector<float> block_intensity(const RangeGrid& grid, const std::vector<std::uint8_t>& keep, int stride) {
  if (grid.intensity.empty()) {
    return {};
  }
  const int rows = (grid.rows + stride - 1) / stride;
  const int cols = (grid.cols + stride - 1) / stride;
  std::vector<float> sum(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols), 0.0F);
  parallel_for_each_index(
      static_cast<std::size_t>(rows),
      [&](std::size_t block_row) {
        std::vector<int> count(static_cast<std::size_t>(cols), 0);
        float* const out = &sum[block_row * static_cast<std::size_t>(cols)];
        const int first = static_cast<int>(block_row) * stride;
        for (int row = first; row < std::min(first + stride, grid.rows); ++row) {
          for (int col = 0; col < grid.cols; ++col) {
            const std::size_t i = grid.index(row, col);
            if (keep[i] != 0 && std::isfinite(grid.intensity[i])) {
              out[col / stride] += grid.intensity[i];
              ++count[static_cast<std::size_t>(col / stride)];
            }
          }
        }
        for (int col = 0; col < cols; ++col) {
          const int n = count[static_cast<std::size_t>(col)];
          out[col] = n > 0 ? out[col] / static_cast<float>(n) : std::numeric_limits<float>::quiet_NaN();
        }
      },
      4);
  return sum;
}

std::vector<std::uint8_t> kept_samples(const RangeGrid& grid, const std::vector<std::uint8_t>& ignore) {
  std::vector<std::uint8_t> keep(grid.size(), 0);
  parallel_for_each_index(
      grid.size(),
      [&](std::size_t i) {
        keep[i] =
            grid.valid[i] != 0 && (ignore.empty() || ignore[i] == 0) && grid.point(i).allFinite() ? 1 : 0;
      },
      16384);
  return keep;
}

std::shared_ptr<ScanSurface> surface_of(const RangeGrid& grid, const std::vector<std::uint8_t>& ignore,
                                        const ScanSurfaceOptions& options) {
  auto out = std::make_shared<ScanSurface>();
  Entered entered{grid, 0, kept_samples(grid, ignore), {}};
  const std::vector<std::uint8_t>& keep = entered.keep;
  for (const std::uint8_t k : keep) {
    out->valid += k;
  }
  out->spacing_mm = grid.spacing_mm > 0 ? grid.spacing_mm : estimate_spacing_mm(grid);
  if (!(out->spacing_mm > 0) || !std::isfinite(out->spacing_mm)) {
    out->spacing_mm = 1.0;  // no two neighbours: there is nothing that a spacing could be wrong for
  }
  out->scale_mm = options.scale_mm > 0 ? options.scale_mm : surface_scale_mm(grid);
  entered.spacing_mm = out->spacing_mm;
  NarrowGapOptions gaps;
  gaps.least_along =
      std::max(gaps.least_along, static_cast<int>(std::ceil(kShortestGap * out->scale_mm / out->spacing_mm)));
  entered.gaps = narrow_gaps(grid, keep, gaps);
  out->toward_camera = -grid.view.direction;
  const auto stride_for = [&](double spacing_mm) {
    return std::clamp(static_cast<int>(std::lround(spacing_mm / out->spacing_mm)), 1, 1 << 12);
  };
  int fine = 1;
  while (out->valid / (static_cast<std::size_t>(fine) * static_cast<std::size_t>(fine)) >
         options.most_fine_samples) {
    ++fine;
  }
  const int medium = std::max(fine, stride_for(options.medium_spacing * out->scale_mm));
  const int coarse = std::max(medium, stride_for(options.coarse_spacing * out->scale_mm));
  side_by_side([&] { out->fine = make_level(entered, fine, options.fine_points, options); },
               [&] { out->medium = make_level(entered, medium, options.medium_points, options); },
               [&] { out->coarse = make_level(entered, coarse, options.coarse_points, options); },
               [&] { out->noise_mm = estimate_noise_mm(grid, keep); });
  out->fine->grid.intensity = block_intensity(grid, keep, fine);
  out->relief = make_relief(*out->medium, block_intensity(grid, keep, medium),
                            std::max(options.relief_radius * out->scale_mm, 3.0 * out->medium->spacing_mm),
                            static_cast<std::size_t>(options.relief_points));

  measure_middle(*out);
  return out;
}

}  // namespace

void measure_middle(ScanSurface& surface) {
  surface.centroid_mm.setZero();
  const SurfaceLevel& level = *surface.medium;
  std::size_t count = 0;
  double spread = 0;
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t i = 0; i < level.grid.size(); ++i) {
      if (level.usable[i] == 0) {
        continue;
      }
      const Eigen::Vector3d p = level.grid.point(i).cast<double>();
      if (pass == 0) {
        surface.centroid_mm += p;
        ++count;
      } else {
        spread += (p - surface.centroid_mm).squaredNorm();
      }
    }
    if (count == 0) {
      break;
    }
    if (pass == 0) {
      surface.centroid_mm /= static_cast<double>(count);
    }
  }
  surface.extent_mm = count == 0 ? 0 : 2.0 * std::sqrt(spread / static_cast<double>(count));
}

double surface_scale_mm(const RangeGrid& grid) {
  const double spacing_mm = grid.spacing_mm > 0 ? grid.spacing_mm : estimate_spacing_mm(grid);
  const auto step2 = static_cast<float>(std::pow(static_cast<double>(kStepFactor) * spacing_mm, 2.0));
  const double area_mm2 = parallel_reduce_ordered(
      static_cast<std::size_t>(std::max(0, grid.rows - 1)), 16, 0.0,
      [&](std::size_t begin, std::size_t end) {
        double part = 0;
        for (auto row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
          for (int col = 0; col + 1 < grid.cols; ++col) {
            const std::size_t i = grid.index(row, col);
            const std::size_t below = grid.index(row + 1, col);
            if (grid.valid[i] == 0 || grid.valid[i + 1] == 0 || grid.valid[below] == 0) {
              continue;
            }
            const Eigen::Vector3f a = grid.point(i + 1) - grid.point(i);
            const Eigen::Vector3f b = grid.point(below) - grid.point(i);
            if (a.squaredNorm() <= step2 && b.squaredNorm() <= step2) {
              part += static_cast<double>(a.cross(b).norm());
            }
          }
        }
        return part;
      },
      [](double& into, double part) { into += part; });
  return std::sqrt(area_mm2);
}

std::shared_ptr<const ScanSurface> make_scan_surface(const RangeGrid& grid,
                                                     const std::vector<std::uint8_t>& ignore,
                                                     const ScanSurfaceOptions& options) {
  return surface_of(grid, ignore, options);
}

std::shared_ptr<const ScanSurface> rescaled(const ScanSurface& surface, const ScanSurfaceOptions& options) {
  std::shared_ptr<ScanSurface> out = surface_of(surface.fine->grid, {}, options);
  // Of the full grid, which the finest level may be coarser than.
  out->spacing_mm = surface.spacing_mm;
  out->noise_mm = surface.noise_mm;
  out->valid = surface.valid;
  return out;
}

}  // namespace dubsar
