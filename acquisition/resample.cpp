// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/resample.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>

#include "acquisition/point_spacing.h"
#include "acquisition/view_axis.h"
#include "core/order_statistics.h"
#include "core/units.h"
#include "formats/seen_side.h"

namespace dubsar {

namespace {

/// Points farther behind the first than this many µ belong to another surface (seed 001, 3.3: 3µ is a slope
/// of 70°).
constexpr float kDepthStep = 3.0F;
/// A mean of unit normals shorter than this points nowhere: the cloud is seen from all around.
constexpr double kNormalsAgree = 0.3;
/// An extent with more cells per point than this is held open by a few strays; the box is then trimmed.
constexpr double kMostCellsPerPoint = 64.0;
/// A spare point fills an empty cell beside its own when it lies this much nearer to it than the point that
/// its own cell keeps, in cells: the order of the points along rows and columns stays what it was.
constexpr float kSpareLead = 0.25F;
/// Points that look for the lattice, the trial spacings on either side, and the coherence that makes one.
constexpr std::size_t kLatticeProbes = 4000;
constexpr int kRefineSteps = 100;
constexpr double kLatticeShare = 0.3;
constexpr std::uint32_t kNone = 0xffffffffU;

struct Frame {
  Eigen::Vector3f u, v, w;  ///< columns, rows, towards the scanner
};

/// Which way the points were seen, and whether that leaves the side open.
struct View {
  Eigen::Vector3d direction;
  bool side_is_open = false;
};

View view_of(const PointCloud& cloud, const std::vector<std::uint32_t>& kept) {
  if (cloud.normals.size() == cloud.points.size() && !cloud.normals.empty()) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const std::uint32_t i : kept) {
      if (cloud.normals[i].allFinite()) {
        mean += cloud.normals[i].cast<double>();
      }
    }
    mean /= static_cast<double>(kept.size());
    if (mean.norm() > kNormalsAgree) {
      return {.direction = -mean.normalized()};
    }
  }
  std::vector<Eigen::Vector3f> points;
  points.reserve(kept.size());
  for (const std::uint32_t i : kept) {
    points.push_back(cloud.points[i]);
  }
  return {.direction = -view_axis(points), .side_is_open = true};
}

Frame frame_of(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d w = -direction;
  // The column axis follows the frame's own x as far as the view allows, so that a scan along z keeps its
  // axes.
  const Eigen::Vector3d along = std::abs(w.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d u = (along - w * w.dot(along)).normalized();
  return {u.cast<float>(), w.cross(u).cast<float>(), w.cast<float>()};
}

/// The points in the view's own axes, and the raster of cells over them.
struct Raster {
  std::vector<Eigen::Vector3f> uvw;  ///< by position in kept
  std::vector<std::uint32_t> kept;   ///< indices into the cloud
  float u_min = 0, v_min = 0, cell = 0;
  std::optional<Eigen::Vector2d> lattice;  ///< where one row and one column of the points lie
  int cols = 0, rows = 0;
  std::vector<std::uint32_t> start;   ///< [rows*cols + 1]
  std::vector<std::uint32_t> points;  ///< positions in uvw, cell by cell, ascending in each

  [[nodiscard]] std::size_t cell_index(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
  }
  [[nodiscard]] std::size_t cell_of(const Eigen::Vector3f& p) const {
    return cell_index(std::clamp(static_cast<int>((p.y() - v_min) / cell), 0, rows - 1),
                      std::clamp(static_cast<int>((p.x() - u_min) / cell), 0, cols - 1));
  }
  [[nodiscard]] Eigen::Vector2f middle(int row, int col) const {
    return {u_min + (static_cast<float>(col) + 0.5F) * cell, v_min + (static_cast<float>(row) + 0.5F) * cell};
  }
};

/// Leaves out the points far outside the box that holds all but a thousandth at either end of each axis.
void trim(Raster& raster) {
  Eigen::Vector2f low;
  Eigen::Vector2f high;
  for (int axis = 0; axis < 2; ++axis) {
    std::vector<float> values;
    values.reserve(raster.uvw.size());
    for (const Eigen::Vector3f& p : raster.uvw) {
      values.push_back(p[axis]);
    }
    const std::size_t last = values.size() - 1;
    const std::size_t cut = std::min(values.size() / 1000 + 1, last);
    low[axis] = value_at_rank(values, cut);
    high[axis] = value_at_rank(values, last - cut);
  }
  const Eigen::Vector2f margin = 0.5F * (high - low) + Eigen::Vector2f::Constant(raster.cell);
  low -= margin;
  high += margin;
  std::size_t to = 0;
  for (std::size_t i = 0; i < raster.uvw.size(); ++i) {
    const auto uv = raster.uvw[i].head<2>().array();
    if ((uv >= low.array()).all() && (uv <= high.array()).all()) {
      raster.uvw[to] = raster.uvw[i];
      raster.kept[to++] = raster.kept[i];
    }
  }
  raster.uvw.resize(to);
  raster.kept.resize(to);
}

/// Finds the rows and columns of a regular cloud, so that its points sit in the middle of the cells: the
/// phase of their Fourier coefficient at the spacing, which may be refined by a twentieth where a median has
/// been taken for it.
void lock_to_lattice(Raster& raster, bool refine) {
  const std::size_t stride = std::max<std::size_t>(1, raster.uvw.size() / kLatticeProbes);
  double best = kLatticeShare;
  const double spacing = raster.cell;
  for (int step = refine ? -kRefineSteps : 0; step <= (refine ? kRefineSteps : 0); ++step) {
    const double period = spacing * (1.0 + 0.05 * step / kRefineSteps);
    std::complex<double> u = 0;
    std::complex<double> v = 0;
    double count = 0;
    for (std::size_t i = 0; i < raster.uvw.size(); i += stride) {
      u += std::polar(1.0, 2.0 * kPi * raster.uvw[i].x() / period);
      v += std::polar(1.0, 2.0 * kPi * raster.uvw[i].y() / period);
      count += 1;
    }
    if (const double share = (std::abs(u) + std::abs(v)) / (2.0 * count); share > best) {
      best = share;
      raster.cell = static_cast<float>(period);
      raster.lattice = Eigen::Vector2d(std::arg(u), std::arg(v)) * period / (2.0 * kPi);
    }
  }
}

/// Lays the cells; returns how many there would be.
double lay_cells(Raster& raster) {
  Eigen::Vector2f low = raster.uvw.front().head<2>();
  Eigen::Vector2f high = low;
  for (const Eigen::Vector3f& p : raster.uvw) {
    low = low.cwiseMin(p.head<2>());
    high = high.cwiseMax(p.head<2>());
  }
  // Half a cell outside, so that points on the border sit in the middle of theirs.
  Eigen::Vector2d corner = low.cast<double>().array() - 0.5 * raster.cell;
  if (raster.lattice) {
    const Eigen::Vector2d edge = raster.lattice->array() - 0.5 * raster.cell;
    corner = edge + ((low.cast<double>() - edge) / raster.cell).array().floor().matrix() * raster.cell;
  }
  raster.u_min = static_cast<float>(corner.x());
  raster.v_min = static_cast<float>(corner.y());
  const double across = std::floor(static_cast<double>(high.x() - raster.u_min) / raster.cell) + 1;
  const double down = std::floor(static_cast<double>(high.y() - raster.v_min) / raster.cell) + 1;
  raster.cols = static_cast<int>(std::min(across, 1e9));
  raster.rows = static_cast<int>(std::min(down, 1e9));
  return across * down;
}

void sort_into_cells(Raster& raster) {
  raster.start.assign(raster.cell_index(raster.rows - 1, raster.cols - 1) + 2, 0);
  for (const Eigen::Vector3f& p : raster.uvw) {
    ++raster.start[raster.cell_of(p) + 1];
  }
  std::partial_sum(raster.start.begin(), raster.start.end(), raster.start.begin());
  std::vector<std::uint32_t> next(raster.start.begin(), raster.start.end() - 1);
  raster.points.resize(raster.uvw.size());
  for (std::uint32_t i = 0; i < raster.uvw.size(); ++i) {
    raster.points[next[raster.cell_of(raster.uvw[i])]++] = i;
  }
}

/// For each cell the point that stands for it, or kNone; tops: the depth of what the scanner sees first.
struct Choice {
  std::vector<std::uint32_t> point;
  std::vector<float> top;
};

Choice choose(const Raster& raster) {
  Choice out;
  out.point.assign(raster.start.size() - 1, kNone);
  out.top.assign(raster.start.size() - 1, 0.0F);
  for (int row = 0; row < raster.rows; ++row) {
    for (int col = 0; col < raster.cols; ++col) {
      const std::size_t cell = raster.cell_index(row, col);
      const Eigen::Vector2f middle = raster.middle(row, col);
      float top = std::numeric_limits<float>::lowest();
      for (std::uint32_t k = raster.start[cell]; k < raster.start[cell + 1]; ++k) {
        top = std::max(top, raster.uvw[raster.points[k]].z());
      }
      float best = std::numeric_limits<float>::max();
      for (std::uint32_t k = raster.start[cell]; k < raster.start[cell + 1]; ++k) {
        const Eigen::Vector3f& p = raster.uvw[raster.points[k]];
        const float distance = (p.head<2>() - middle).squaredNorm();
        if (p.z() >= top - kDepthStep * raster.cell && distance < best) {
          best = distance;
          out.point[cell] = raster.points[k];
        }
      }
      out.top[cell] = top;
    }
  }
  return out;
}

/// A regular cloud whose rows lie askew to the cells leaves some empty and puts two points into others. The
/// spare ones go to the empty cells beside theirs: a grid need not be rectilinear.
void place_spares(const Raster& raster, Choice& choice) {
  const std::vector<std::uint32_t> first = choice.point;
  std::vector<std::uint8_t> placed(raster.uvw.size(), 0);
  for (int row = 0; row < raster.rows; ++row) {
    for (int col = 0; col < raster.cols; ++col) {
      const std::size_t cell = raster.cell_index(row, col);
      if (first[cell] != kNone) {
        continue;
      }
      const Eigen::Vector2f middle = raster.middle(row, col);
      float best = std::numeric_limits<float>::max();
      for (int dv = -1; dv <= 1; ++dv) {
        for (int du = -1; du <= 1; ++du) {
          if (row + dv < 0 || row + dv >= raster.rows || col + du < 0 || col + du >= raster.cols) {
            continue;
          }
          const std::size_t beside = raster.cell_index(row + dv, col + du);
          if (first[beside] == kNone) {
            continue;
          }
          const Eigen::Vector2f towards(-static_cast<float>(du), -static_cast<float>(dv));
          const Eigen::Vector2f owner = raster.uvw[first[beside]].head<2>();
          for (std::uint32_t k = raster.start[beside]; k < raster.start[beside + 1]; ++k) {
            const std::uint32_t spare = raster.points[k];
            const Eigen::Vector3f& p = raster.uvw[spare];
            const Eigen::Vector2f off = p.head<2>() - middle;
            if (spare == first[beside] || placed[spare] != 0 || off.cwiseAbs().maxCoeff() > raster.cell ||
                p.z() < choice.top[beside] - kDepthStep * raster.cell ||
                (p.head<2>() - owner).dot(towards) / towards.norm() < kSpareLead * raster.cell) {
              continue;
            }
            if (off.squaredNorm() < best) {
              best = off.squaredNorm();
              choice.point[cell] = spare;
            }
          }
        }
      }
      if (choice.point[cell] != kNone) {
        placed[choice.point[cell]] = 1;
      }
    }
  }
}

RangeGrid grid_of(const PointCloud& cloud, const Raster& raster, const Choice& choice) {
  RangeGrid grid;
  grid.allocate(raster.rows, raster.cols);
  grid.intensity.assign(cloud.intensity.size() == cloud.points.size() ? grid.size() : 0, 0.0F);
  grid.rgb.assign(cloud.rgb.size() == 3 * cloud.points.size() ? 3 * grid.size() : 0, 0);
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    if (choice.point[cell] == kNone) {
      continue;
    }
    const std::size_t i = raster.kept[choice.point[cell]];
    grid.x[cell] = cloud.points[i].x();
    grid.y[cell] = cloud.points[i].y();
    grid.z[cell] = cloud.points[i].z();
    grid.valid[cell] = 1;
    if (!grid.intensity.empty()) {
      grid.intensity[cell] = cloud.intensity[i];
    }
    for (std::size_t k = 0; k < 3 && !grid.rgb.empty(); ++k) {
      grid.rgb[3 * cell + k] = cloud.rgb[3 * i + k];
    }
  }
  return grid;
}

}  // namespace

Status ResampleOptions::check() const {
  if (!std::isfinite(spacing_mm) || spacing_mm < 0 || max_cells < 1 ||
      (view_direction && !(view_direction->allFinite() && std::abs(view_direction->norm() - 1.0) < 1e-3))) {
    return fail(ErrorKind::kUsage, "resampling takes a spacing of 0 or more and a unit view direction");
  }
  return {};
}

Result<RangeGrid> resample(const PointCloud& cloud, const ResampleOptions& options, JobContext& job) {
  if (Status checked = options.check(); !checked) {
    return std::unexpected(checked.error());
  }
  Raster raster;
  raster.kept.reserve(cloud.points.size());
  for (std::uint32_t i = 0; i < cloud.points.size(); ++i) {
    if (cloud.points[i].allFinite()) {
      raster.kept.push_back(i);
    }
  }
  if (raster.kept.size() < 3) {
    return bad_input(cloud.source, "fewer than three points", "scan again");
  }
  const View view =
      options.view_direction ? View{.direction = *options.view_direction} : view_of(cloud, raster.kept);
  const Eigen::Vector3d& direction = view.direction;
  const Frame frame = frame_of(direction);
  raster.uvw.reserve(raster.kept.size());
  for (const std::uint32_t i : raster.kept) {
    const Eigen::Vector3f& p = cloud.points[i];
    raster.uvw.emplace_back(frame.u.dot(p), frame.v.dot(p), frame.w.dot(p));
  }
  const NeighbourStatistics neighbours = nearest_neighbours(raster.uvw);
  if (neighbours.lattice_rad) {
    // Cells along the rows that the points were scanned in: one point to a cell, few empty, few with two.
    const auto cosine = static_cast<float>(std::cos(*neighbours.lattice_rad));
    const auto sine = static_cast<float>(std::sin(*neighbours.lattice_rad));
    for (Eigen::Vector3f& p : raster.uvw) {
      p = {cosine * p.x() + sine * p.y(), cosine * p.y() - sine * p.x(), p.z()};
    }
  }
  double spacing = options.spacing_mm;
  if (spacing == 0) {
    spacing = std::max(neighbours.median_mm, even_spacing_mm(raster.uvw, neighbours.median_mm));
  }
  if (!(spacing > 0)) {
    return bad_input(cloud.source, "all points lie on one spot", "scan again");
  }
  if (job.cancelled()) {
    return fail(ErrorKind::kCancelled, "resampling cancelled", cloud.source);
  }
  raster.cell = static_cast<float>(spacing);
  lock_to_lattice(raster, options.spacing_mm == 0);
  double cells = lay_cells(raster);
  if (cells > kMostCellsPerPoint * static_cast<double>(raster.uvw.size()) + 4096) {
    trim(raster);
    cells = lay_cells(raster);
  }
  if (cells > static_cast<double>(options.max_cells)) {
    return bad_input(cloud.source, "the points lie too far apart for a grid of their spacing",
                     "cut away what is not the tablet, or give the spacing");
  }
  sort_into_cells(raster);
  Choice choice = choose(raster);
  if (job.cancelled()) {
    return fail(ErrorKind::kCancelled, "resampling cancelled", cloud.source);
  }
  place_spares(raster, choice);
  RangeGrid grid = grid_of(cloud, raster, choice);
  grid.spacing_mm = raster.cell;
  grid.view.direction = direction;
  grid.source = cloud.source;
  if (const int side = view.side_is_open ? outline_side(grid) : 1; side != 1) {
    ResampleOptions turned = options;
    turned.view_direction = -direction;
    Result<RangeGrid> from_there = resample(cloud, turned, job);
    // An outline that tells nothing from behind, where its rim hides itself, may tell from the front.
    if (!from_there || side == -1 || outline_side(*from_there) == 1) {
      return from_there;
    }
  }
  return grid;
}

}  // namespace dubsar
