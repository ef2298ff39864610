// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/stitch_surface.h"

#include <algorithm>

#include "core/grid_geometry.h"
#include "core/grid_noise.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

/// What a surface through samples µ apart is off by however little they err: of µ.
constexpr double kSystematicOfSpacing = 0.1;
/// At the rim a camera sees part of what lies beyond.
constexpr float kRimWeight = 0.5F;
/// Sparse samples hold the surface together where there is nothing better, and hardly count where there is.
constexpr float kSparseWeight = 0.25F;
constexpr float kSparseScore = 0.1F;

ScannerView view_in_model(const ScannerView& view, const RigidTransform& model_from_scanner) {
  ScannerView out;
  out.direction = model_from_scanner.rotation * view.direction;
  if (view.laser_mm) {
    out.laser_mm = model_from_scanner * *view.laser_mm;
  }
  if (view.camera_mm) {
    out.camera_mm = model_from_scanner * *view.camera_mm;
  }
  out.motion_per_row_mm = model_from_scanner.rotation * view.motion_per_row_mm;
  return out;
}

/// Samples to the rim of the triangulated area, eight-connected: 1 on the rim, at most `most`.
std::vector<std::uint8_t> rim_distance(const std::vector<std::uint8_t>& usable,
                                       const std::vector<std::uint8_t>& cells, int rows, int cols, int most) {
  std::vector<std::uint8_t> distance(usable.size(), 0);
  const auto width = static_cast<std::size_t>(cols);
  const auto full = [&](std::size_t cell) {
    return (cells[cell] & (kCellFirst | kCellSecond)) == (kCellFirst | kCellSecond);
  };
  parallel_for_each_index(
      static_cast<std::size_t>(rows),
      [&](std::size_t row) {
        for (std::size_t col = 0; col < width; ++col) {
          const std::size_t i = row * width + col;
          if (usable[i] == 0) {
            continue;
          }
          const bool inner =
              row > 0 && col > 0 && full(i) && full(i - 1) && full(i - width) && full(i - width - 1);
          distance[i] = inner ? static_cast<std::uint8_t>(most) : 1;
        }
      },
      16);
  // Two passes: from above and the left, then back.
  const auto relax = [&](std::size_t i, std::size_t from) {
    distance[i] = std::min<std::uint8_t>(distance[i], static_cast<std::uint8_t>(distance[from] + 1));
  };
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (distance[i] > 1) {
      relax(i, i - 1);
      relax(i, i - width);
      relax(i, i - width - 1);
      relax(i, i - width + 1);
    }
  }
  for (std::size_t i = distance.size(); i-- > 0;) {
    if (distance[i] > 1) {
      relax(i, i + 1);
      relax(i, i + width);
      relax(i, i + width + 1);
      relax(i, i + width - 1);
    }
  }
  return distance;
}

}  // namespace

void box_mean(std::vector<float>& values, const std::vector<std::uint8_t>& mask, int rows, int cols,
              int radius) {
  if (radius <= 0 || values.empty()) {
    return;
  }
  const auto width = static_cast<std::size_t>(cols);
  const auto height = static_cast<std::size_t>(rows);
  const auto r = static_cast<std::size_t>(radius);
  std::vector<float> sums(values.size());
  std::vector<std::uint16_t> counts(values.size());
  parallel_for_each_index(
      height,
      [&](std::size_t row) {
        const std::size_t base = row * width;
        double sum = 0;
        int count = 0;
        const auto add = [&](std::size_t col, int sign) {
          if (mask[base + col] != 0) {
            sum += sign * static_cast<double>(values[base + col]);
            count += sign;
          }
        };
        for (std::size_t col = 0; col < std::min(r, width); ++col) {
          add(col, 1);
        }
        for (std::size_t col = 0; col < width; ++col) {
          if (col + r < width) {
            add(col + r, 1);
          }
          if (col > r) {
            add(col - r - 1, -1);
          }
          sums[base + col] = static_cast<float>(sum);
          counts[base + col] = static_cast<std::uint16_t>(count);
        }
      },
      16);
  // Columns in strips that fit a cache line or two.
  parallel_chunks(width, 64, [&](std::size_t begin, std::size_t end) {
    std::vector<double> sum(end - begin, 0);
    std::vector<int> count(end - begin, 0);
    const auto add = [&](std::size_t row, int sign) {
      for (std::size_t col = begin; col < end; ++col) {
        sum[col - begin] += sign * static_cast<double>(sums[row * width + col]);
        count[col - begin] += sign * counts[row * width + col];
      }
    };
    for (std::size_t row = 0; row < std::min(r, height); ++row) {
      add(row, 1);
    }
    for (std::size_t row = 0; row < height; ++row) {
      if (row + r < height) {
        add(row + r, 1);
      }
      if (row > r) {
        add(row - r - 1, -1);
      }
      for (std::size_t col = begin; col < end; ++col) {
        const int n = count[col - begin];
        values[row * width + col] =
            mask[row * width + col] != 0 && n > 0 ? static_cast<float>(sum[col - begin] / n) : 0.0F;
      }
    }
  });
}

StitchSurface make_scan_surface(const PlacedScan& scan, const StitchSurfaceOptions& options) {
  const RangeGrid& grid = *scan.grid;
  StitchSurface out;
  out.scan = scan;
  out.spacing_mm = grid.spacing_mm > 0 ? grid.spacing_mm : estimate_spacing_mm(grid);
  out.view = view_in_model(grid.view, scan.model_from_scanner);
  out.scanner_from_model = scan.model_from_scanner.inverse();
  const std::size_t n = grid.size();
  out.points.assign(n, Vector3f::Zero());
  out.usable.assign(n, 0);
  out.cells.assign(n, 0);
  out.reliability.assign(n, 0);
  out.weight.assign(n, 0);
  out.score.assign(n, 0);
  out.rim.assign(n, 0);
  if (!(out.spacing_mm > 0) || grid.rows < 2 || grid.cols < 2) {
    out.normals.assign(n, Vector3f::Zero());
    out.lookup = std::make_unique<GridLookup>(grid, out.usable);
    return out;
  }
  GridGeometry geometry = grid_geometry(grid, 5.0 * out.spacing_mm / std::max(grid.spacing_mm, 1e-12));
  out.normals = std::move(geometry.normals);
  const Eigen::Matrix3f rotation = scan.model_from_scanner.rotation.cast<float>();
  std::vector<std::uint8_t> joined(n, 0);
  parallel_for_each_index(
      n,
      [&](std::size_t i) {
        if (grid.valid[i] == 0 || !grid.point(i).allFinite() ||
            (scan.flags != nullptr && i < scan.flags->size() && ((*scan.flags)[i] & kNotTablet) != 0)) {
          return;
        }
        out.points[i] = (scan.model_from_scanner * grid.point(i).cast<double>()).cast<float>();
        out.normals[i] = rotation * out.normals[i];
        joined[i] = 1;
      },
      4096);
  const GridSurface surface = out.surface();
  out.mirrored = is_mirrored(surface, joined);
  out.cells = triangulate_cells(surface, joined, out.mirrored, options.grid);
  for (int row = 0; row + 1 < grid.rows; ++row) {
    for (int col = 0; col + 1 < grid.cols; ++col) {
      const std::uint8_t cell = out.cells[grid.index(row, col)];
      for (int which = 0; cell != 0 && which < 2; ++which) {
        if ((cell & (which == 0 ? kCellFirst : kCellSecond)) != 0) {
          for (const std::size_t i : cell_triangle(surface, row, col, cell, which)) {
            out.usable[i] = 1;
          }
        }
      }
    }
  }
  const int most = std::clamp(options.rise_samples + 1, 2, kMostRim);
  out.rim = rim_distance(out.usable, out.cells, grid.rows, grid.cols, kMostRim);
  out.noise_mm = scan.noise_mm ? *scan.noise_mm : estimate_noise_mm(grid, out.usable);
  const double systematic_mm = kSystematicOfSpacing * out.spacing_mm;
  const auto inverse_variance =
      static_cast<float>(1.0 / (out.noise_mm * out.noise_mm + systematic_mm * systematic_mm));
  parallel_for_each_index(
      n,
      [&](std::size_t i) {
        if (out.usable[i] == 0) {
          return;
        }
        const Eigen::Vector3d to_camera = out.view.to_camera(out.points[i].cast<double>(), grid.row_of(i));
        const float cosine = std::clamp(out.normals[i].dot(to_camera.cast<float>()), 0.05F, 1.0F);
        const float confidence = grid.confidence.empty() ? 1.0F : std::clamp(grid.confidence[i], 0.01F, 1.0F);
        out.reliability[i] = cosine * cosine * confidence;
        const bool sparse = out.is_sparse(i);
        const float doubt = sparse ? kSparseWeight : out.rim[i] <= 1 ? kRimWeight : 1.0F;
        out.weight[i] = confidence * inverse_variance * doubt;
        out.score[i] = sparse ? kSparseScore * cosine : cosine;
      },
      4096);
  box_mean(out.score, out.usable, grid.rows, grid.cols, options.incidence_radius_samples);
  parallel_for_each_index(
      n,
      [&](std::size_t i) {
        if (out.usable[i] != 0) {
          out.score[i] *= static_cast<float>(std::min<int>(out.rim[i], most)) / static_cast<float>(most);
        }
      },
      4096);
  for (std::size_t i = 0; i < n; ++i) {
    if (out.usable[i] != 0) {
      out.box.extend(out.points[i]);
    }
  }
  out.lookup = std::make_unique<GridLookup>(grid, out.usable, 1.5 * out.spacing_mm);
  return out;
}

}  // namespace dubsar
