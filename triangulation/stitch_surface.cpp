// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/stitch_surface.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "core/grid_geometry.h"
#include "core/grid_noise.h"
#include "core/parallel.h"
#include "triangulation/normal_noise.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

/// What a surface through samples µ apart is off by however little they err: of µ.
constexpr double kSystematicOfSpacing = 0.1;
/// No scanner errs less, and made-up scans without noise have a sigma, too.
constexpr double kLeastNoiseMm = 1e-4;
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

/// 1 for samples all of whose cells are whole.
std::vector<std::uint8_t> inner_samples(const std::vector<std::uint8_t>& cells, int rows, int cols) {
  std::vector<std::uint8_t> inner(cells.size(), 0);
  const auto width = static_cast<std::size_t>(cols);
  constexpr std::uint8_t kWhole = kCellFirst | kCellSecond;
  parallel_for_each_index(
      static_cast<std::size_t>(std::max(rows - 2, 0)),
      [&](std::size_t above) {
        for (std::size_t i = (above + 1) * width + 1; i + 1 < (above + 2) * width; ++i) {
          const int all = cells[i] & cells[i - 1] & cells[i - width] & cells[i - width - 1];
          inner[i] = (all & kWhole) == kWhole ? 1 : 0;
        }
      },
      16);
  return inner;
}

/// In place: the least of the values in the 3x3 square around each.
void shrink(std::vector<std::uint8_t>& values, int rows, int cols) {
  const auto width = static_cast<std::size_t>(cols);
  const auto height = static_cast<std::size_t>(rows);
  std::vector<std::uint8_t> along(values.size());
  parallel_for_each_index(
      height,
      [&](std::size_t row) {
        const std::uint8_t* const in = &values[row * width];
        std::uint8_t* const out = &along[row * width];
        out[0] = std::min(in[0], in[1]);
        for (std::size_t c = 1; c + 1 < width; ++c) {
          out[c] = std::min({in[c - 1], in[c], in[c + 1]});
        }
        out[width - 1] = std::min(in[width - 2], in[width - 1]);
      },
      16);
  parallel_for_each_index(
      height,
      [&](std::size_t row) {
        const std::uint8_t* const here = &along[row * width];
        const std::uint8_t* const before = row > 0 ? here - width : here;
        const std::uint8_t* const after = row + 1 < height ? here + width : here;
        for (std::size_t c = 0; c < width; ++c) {
          values[row * width + c] = std::min({before[c], here[c], after[c]});
        }
      },
      16);
}

/// Samples to the rim of the triangulated area, eight-connected: 1 on the rim, at most kMostRim. Gaps of one
/// sample have no rim: else each drop-out would make the samples around it look bad.
std::vector<std::uint8_t> rim_distance(const std::vector<std::uint8_t>& usable,
                                       const std::vector<std::uint8_t>& inner, int rows, int cols) {
  const auto width = static_cast<std::size_t>(cols);
  const auto height = static_cast<std::size_t>(rows);
  std::vector<std::uint8_t> covered = usable;
  parallel_for_each_index(
      height,
      [&](std::size_t row) {
        for (std::size_t col = 0; col < width; ++col) {
          const std::size_t i = row * width + col;
          const bool along = col > 0 && col + 1 < width && (usable[i - 1] & usable[i + 1]) != 0;
          const bool across = row > 0 && row + 1 < height && (usable[i - width] & usable[i + width]) != 0;
          covered[i] |= along || across ? 1 : 0;
        }
      },
      16);
  std::vector<std::uint8_t> within = covered;
  shrink(within, rows, cols);
  std::vector<std::uint8_t> distance = std::move(covered);
  for (std::size_t row = 1; row + 1 < height; ++row) {
    for (std::size_t i = row * width + 1; i + 1 < (row + 1) * width; ++i) {
      distance[i] = (within[i] | inner[i]) != 0 ? static_cast<std::uint8_t>(kMostRim) : distance[i];
    }
  }
  // Two passes, from above and the left, then back: first what the row before says, then along the row.
  const auto relax = [&](std::size_t row, std::size_t before) {
    std::uint8_t* const here = &distance[row * width];
    const std::uint8_t* const from = &distance[before * width];
    for (std::size_t c = 1; c + 1 < width; ++c) {
      const std::uint8_t nearest = std::min(std::min(from[c - 1], from[c]), from[c + 1]);
      here[c] = std::min<std::uint8_t>(here[c], static_cast<std::uint8_t>(nearest + 1));
    }
    return here;
  };
  for (std::size_t row = 1; row + 1 < height; ++row) {
    std::uint8_t* const here = relax(row, row - 1);
    std::uint8_t last = here[0];
    for (std::size_t c = 1; c + 1 < width; ++c) {
      here[c] = last = std::min<std::uint8_t>(here[c], static_cast<std::uint8_t>(last + 1));
    }
  }
  for (std::size_t row = height - 1; row-- > 1;) {
    std::uint8_t* const here = relax(row, row + 1);
    std::uint8_t last = here[width - 1];
    for (std::size_t c = width - 1; c-- > 1;) {
      here[c] = last = std::min<std::uint8_t>(here[c], static_cast<std::uint8_t>(last + 1));
    }
  }
  return distance;
}

/// The cosine of the incidence of what a camera sees in a row: 0.05 at the least.
class Incidence {
 public:
  Incidence(const ScannerView& view, std::size_t row) : against_(-view.direction.cast<float>()) {
    if (view.camera_mm) {
      camera_ = Vector3f(view.camera_mm->cast<float>() +
                         static_cast<float>(row) * view.motion_per_row_mm.cast<float>());
    }
  }
  [[nodiscard]] float cosine(const Vector3f& p, const Vector3f& normal) const {
    const Vector3f to_camera = camera_ ? Vector3f((*camera_ - p).normalized()) : against_;
    return std::clamp(normal.dot(to_camera), 0.05F, 1.0F);
  }

 private:
  Vector3f against_;
  std::optional<Vector3f> camera_;
};

/// The sample that stands for each node, and how much the scan wants to be primary there.
void lay_nodes(StitchSurface& out, const std::vector<float>& cosines, const StitchSurfaceOptions& options) {
  const Lattice& lattice = out.lattice;
  const int most = std::clamp(options.rise_samples + 1, 2, kMostRim);
  std::vector<std::uint8_t> seen(lattice.size(), 0);
  std::vector<float> rise(lattice.size(), 0);
  parallel_for_each_index(
      lattice.size(),
      [&](std::size_t node) {
        const int middle_row = lattice.row_of(node) * Lattice::kNodeSide + 1;
        const int middle_col = lattice.col_of(node) * Lattice::kNodeSide + 1;
        int nearest = std::numeric_limits<int>::max();
        float sum = 0;
        int count = 0;
        int rim = 0;
        lattice.for_each_place(node, [&](int row, int col, std::size_t i) {
          if (out.usable[i] == 0) {
            return;
          }
          const int dr = row - middle_row;
          const int dc = col - middle_col;
          if (dr * dr + dc * dc < nearest) {
            nearest = dr * dr + dc * dc;
            out.node_sample[node] = static_cast<std::int32_t>(i);
          }
          sum += out.is_sparse(i) ? kSparseScore * cosines[i] : cosines[i];
          rim += std::min<int>(out.rim[i], most);
          ++count;
        });
        if (count > 0) {
          seen[node] = 1;
          out.score[node] = sum / static_cast<float>(count);
          rise[node] = static_cast<float>(rim) / static_cast<float>(most * count);
        }
      },
      1024);
  box_mean(out.score, seen, lattice.node_rows, lattice.node_cols,
           options.incidence_radius_samples / Lattice::kNodeSide);
  // Samples for a length of the surface, along which they lie widest: a scan as fine as others stands out
  // where it looks straight at the clay, a coarse one never over a fine one that sees it well.
  const float per_mm = out.spacing_mm > 0 ? 1.0F / static_cast<float>(out.spacing_mm) : 1.0F;
  for (std::size_t node = 0; node < seen.size(); ++node) {
    out.score[node] *= rise[node] * per_mm;
  }
}

/// One of each 2x2 block: enough to start from for a walk to the nearest sample.
std::vector<std::uint8_t> every_fourth(const std::vector<std::uint8_t>& usable, int rows, int cols) {
  std::vector<std::uint8_t> out(usable.size(), 0);
  const auto width = static_cast<std::size_t>(cols);
  for (std::size_t row = 0; row + 1 < static_cast<std::size_t>(rows); row += 2) {
    for (std::size_t i = row * width; i + 1 < (row + 1) * width; i += 2) {
      for (const std::size_t k : {i, i + 1, i + width, i + width + 1}) {
        if (usable[k] != 0) {
          out[k] = 1;
          break;
        }
      }
    }
  }
  return out;
}

/// One without triangles, laid out for the grid.
StitchSurface bare_surface(const PlacedScan& scan) {
  const RangeGrid& grid = *scan.grid;
  StitchSurface out;
  out.id = scan.id;
  out.told_pose_sigma_mm = out.pose_sigma_mm = scan.sigma_mm;
  out.is_fixed = scan.is_fixed;
  out.spacing_mm = grid.spacing_mm > 0 ? grid.spacing_mm : estimate_spacing_mm(grid);
  out.lattice = Lattice(grid.rows, grid.cols);
  out.node_sample.assign(out.lattice.size(), -1);
  out.score.assign(out.lattice.size(), 0);
  out.view = view_in_model(grid.view, scan.model_from_scanner);
  out.scanner_from_model = scan.model_from_scanner.inverse();
  const std::size_t n = grid.size();
  out.points.assign(n, Vector3f::Zero());
  out.normals.assign(n, PackedNormal());
  out.cells.assign(n, 0);
  out.usable.assign(n, 0);
  out.reliability_code.assign(n, 0);
  out.weight_code.assign(n, 0);
  out.rim.assign(n, 0);
  if (n > 0 && grid.rgb.size() == 3 * n) {
    out.colours.resize(n);
    std::memcpy(out.colours.data(), grid.rgb.data(), grid.rgb.size());
  }
  return out;
}

std::uint8_t flags_of(const PlacedScan& scan, std::size_t sample) {
  return scan.flags != nullptr && sample < scan.flags->size() ? (*scan.flags)[sample] : std::uint8_t{0};
}

/// Takes the tablet's samples and their normals to the model frame; 1 for each of them.
std::vector<std::uint8_t> place_samples(const PlacedScan& scan, std::vector<Vector3f>& points,
                                        std::vector<Vector3f>& normals) {
  const RangeGrid& grid = *scan.grid;
  const Eigen::Matrix3f rotation = scan.model_from_scanner.rotation.cast<float>();
  std::vector<std::uint8_t> placed(grid.size(), 0);
  parallel_for_each_index(
      grid.size(),
      [&](std::size_t i) {
        if (grid.valid[i] == 0 || !grid.point(i).allFinite() || (flags_of(scan, i) & kNotTablet) != 0) {
          return;
        }
        points[i] = (scan.model_from_scanner * grid.point(i).cast<double>()).cast<float>();
        normals[i] = rotation * normals[i];
        placed[i] = 1;
      },
      4096);
  return placed;
}

/// A sample of no confidence still counts for a little; one that is not a number says as little as 0.
float told_confidence(float told) {
  constexpr float kLeast = 0.01F;
  return told > kLeast ? std::min(told, 1.0F) : kLeast;
}

/// Reliability and weight of the usable samples, and which of them are sparse. Returns the cosines of their
/// angles of incidence.
std::vector<float> weigh_samples(const PlacedScan& scan, const std::vector<Vector3f>& normals,
                                 const std::vector<std::uint8_t>& inner, StitchSurface& out) {
  const RangeGrid& grid = *scan.grid;
  const auto code = [](float part) {
    return static_cast<std::uint16_t>(std::clamp(part, 0.0F, 1.0F) * StitchSurface::kCodes + 0.5F);
  };
  std::vector<float> cosines(grid.size());
  parallel_for_each_index(
      static_cast<std::size_t>(grid.rows),
      [&](std::size_t row) {
        const Incidence incidence(out.view, row);
        const std::size_t end = grid.index(static_cast<int>(row) + 1, 0);
        for (std::size_t i = grid.index(static_cast<int>(row), 0); i < end; ++i) {
          out.normals[i] = PackedNormal(normals[i]);
          if (out.usable[i] == 0) {
            continue;
          }
          out.usable[i] = is_unflagged(flags_of(scan, i)) ? kUsable : kUsable | kUsableSparse;
          const float cosine = incidence.cosine(out.points[i], normals[i]);
          cosines[i] = cosine;
          const float confidence = grid.confidence.empty() ? 1.0F : told_confidence(grid.confidence[i]);
          out.reliability_code[i] = code(cosine * cosine * confidence);
          const float doubt = out.is_sparse(i) ? kSparseWeight : inner[i] == 0 ? kRimWeight : 1.0F;
          out.weight_code[i] = std::max<std::uint16_t>(code(confidence * doubt), 1);
        }
      },
      16);
  return cosines;
}

Eigen::AlignedBox3f box_of_usable(const StitchSurface& surface) {
  return parallel_reduce_ordered(
      surface.points.size(), 65536, Eigen::AlignedBox3f(),
      [&](std::size_t begin, std::size_t end) {
        Eigen::AlignedBox3f box;
        for (std::size_t i = begin; i < end; ++i) {
          if (surface.usable[i] != 0) {
            box.extend(surface.points[i]);
          }
        }
        return box;
      },
      [](Eigen::AlignedBox3f& total, const Eigen::AlignedBox3f& part) { total.extend(part); });
}

}  // namespace

float StitchSurface::pose_variance_mm2() const {
  const float along_mm =
      std::isfinite(pose_sigma_mm) ? static_cast<float>(pose_sigma_mm / std::sqrt(3.0)) : 0.0F;
  return along_mm * along_mm;
}

bool StitchSurface::take_misplacement(const Misplacement& misplacement) {
  const SmallMotion before = std::exchange(back, misplacement.back);
  const double before_mm =
      std::exchange(pose_sigma_mm, back.is_none() ? told_pose_sigma_mm : misplacement.left_mm);
  const auto together_mm = static_cast<float>(misplacement.together_mm);
  const float together_before = std::exchange(together_variance_mm2, together_mm * together_mm / 3.0F);
  pose_share = 1.0F / (1.0F + pose_variance_mm2() * weight_of_best);
  return back != before || together_variance_mm2 != together_before ||
         (pose_sigma_mm != before_mm && !(std::isnan(pose_sigma_mm) && std::isnan(before_mm)));
}

StitchSurface make_scan_surface(const PlacedScan& scan, const StitchSurfaceOptions& options,
                                const JobContext& job) {
  const RangeGrid& grid = *scan.grid;
  StitchSurface out = bare_surface(scan);
  if (!(out.spacing_mm > 0) || grid.rows < 2 || grid.cols < 2) {
    out.lookup = std::make_unique<GridLookup>(grid, out.usable);
    return out;
  }
  if (job.cancelled()) {
    return out;
  }
  GridGeometry geometry = grid_geometry_within(grid, 5.0 * out.spacing_mm);
  std::vector<Vector3f> normals = std::move(geometry.normals);
  const std::vector<std::uint8_t> placed = place_samples(scan, out.points, normals);
  GridSurface surface = out.surface();
  surface.normals = normals;
  if (job.cancelled()) {
    return out;
  }
  out.mirrored = is_mirrored(surface, placed);
  out.cells = triangulate_cells(surface, placed, out.mirrored, options.grid);
  out.usable = corners_of_cells(out.cells, grid.rows, grid.cols);
  if (job.cancelled()) {
    return out;
  }
  const std::vector<std::uint8_t> inner = inner_samples(out.cells, grid.rows, grid.cols);
  out.rim = rim_distance(out.usable, inner, grid.rows, grid.cols);
  if (job.cancelled()) {
    return out;
  }
  out.noise_mm = scan.noise_mm ? *scan.noise_mm : estimate_noise_mm(grid, out.usable);
  const double systematic_mm = kSystematicOfSpacing * out.spacing_mm;
  out.weight_of_best =
      static_cast<float>(1.0 / (out.noise_mm * out.noise_mm + systematic_mm * systematic_mm));
  out.pose_share = 1.0F / (1.0F + out.pose_variance_mm2() * out.weight_of_best);
  const double normal_noise_mm =
      std::max(noise_along_normal_mm(surface, out.usable).value_or(out.noise_mm), kLeastNoiseMm);
  out.variance_of_weight = static_cast<float>(normal_noise_mm * normal_noise_mm) * out.weight_of_best;
  if (job.cancelled()) {
    return out;
  }
  lay_nodes(out, weigh_samples(scan, normals, inner, out), options);
  out.box = box_of_usable(out);
  out.lookup = std::make_unique<GridLookup>(grid, every_fourth(out.usable, grid.rows, grid.cols),
                                            2.5 * out.spacing_mm);
  return out;
}

}  // namespace dubsar
