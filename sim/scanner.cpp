// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/scanner.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "core/random.h"

namespace dubsar::sim {

namespace {

constexpr int kRowsPerBlock = 32;
/// Rays that look for shadow start this far off the surface, so that it does not shade itself.
constexpr double kShadowMarginMm = 0.02;
/// Neighbours farther apart than this many µ lie on two sides of a depth edge.
constexpr double kDepthEdge = 5.0;

struct RowBuffer {
  std::vector<float> x, y, z, intensity;
  std::vector<std::uint8_t> valid;
  explicit RowBuffer(std::size_t cols) : x(cols), y(cols), z(cols), intensity(cols), valid(cols) {}
};

/// White noise made to hang together over about `length` samples, of unit variance.
std::vector<double> correlated(const std::vector<double>& white, double length) {
  const int reach = std::max(0, static_cast<int>(std::ceil(2.5 * length)));
  std::vector<double> kernel(static_cast<std::size_t>(2 * reach + 1));
  double power = 0;
  for (int k = -reach; k <= reach; ++k) {
    const double s = length > 0 ? k / length : 0.0;
    kernel[static_cast<std::size_t>(k + reach)] = std::exp(-s * s);
    power += std::exp(-2.0 * s * s);
  }
  const auto count = static_cast<int>(white.size()) - 2 * reach;
  std::vector<double> out(static_cast<std::size_t>(std::max(0, count)));
  for (std::size_t i = 0; i < out.size(); ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      sum += kernel[k] * white[i + k];
    }
    out[i] = sum / std::sqrt(power);
  }
  return out;
}

/// What the laser's fan meets in one row, before the detector.
struct TrueSample {
  double distance_mm = 0;
  double cosine = 0;  ///< the flatter of laser and camera
  double cosine_laser = 0;
  double albedo = 0;
  bool seen = false;
};

class RowScanner {
 public:
  RowScanner(const ScannerOptions& options, const Scene& scene, const RigidTransform& tablet_from_scanner,
             const ScanLayout& layout, std::uint64_t seed)
      : options_(options), scene_(scene), pose_(tablet_from_scanner), layout_(layout), seed_(seed) {}

  void scan(int row, RowBuffer* out) const {
    const auto cols = static_cast<std::size_t>(layout_.cols);
    const double y = layout_.first_y_mm + row * layout_.spacing_mm;
    std::vector<Eigen::Vector3d> directions(cols);
    std::vector<TrueSample> truth(cols);
    for (std::size_t c = 0; c < cols; ++c) {
      const double x = layout_.first_x_mm + static_cast<double>(c) * layout_.spacing_mm;
      directions[c] = Eigen::Vector3d(x, 0, -options_.standoff_mm).normalized();
      truth[c] = look(y, directions[c]);
    }
    detect(row, y, directions, truth, out);
  }

 private:
  TrueSample look(double y, const Eigen::Vector3d& direction) const {
    TrueSample sample;
    const Eigen::Vector3d laser(0, y, options_.standoff_mm);
    const Eigen::Vector3d ray = pose_.rotation * direction;
    const auto hit = first_hit(scene_, pose_ * laser, ray, 2.0 * options_.standoff_mm);
    if (!hit || hit->albedo <= 0) {
      return sample;
    }
    const Eigen::Vector3d p = laser + hit->distance_mm * direction;
    if (std::abs(p.z()) > 0.5 * options_.depth_range_mm) {
      return sample;
    }
    const Eigen::Vector3d at = pose_ * p;
    const Eigen::Vector3d camera = pose_ * Eigen::Vector3d(0, y + options_.baseline_mm, options_.standoff_mm);
    sample.distance_mm = hit->distance_mm;
    sample.albedo = hit->albedo;
    sample.cosine_laser = -hit->normal.dot(ray);
    sample.cosine = std::min(sample.cosine_laser, hit->normal.dot((camera - at).normalized()));
    sample.seen = sample.cosine > options_.grazing_cosine && !blocked(scene_, at, camera, kShadowMarginMm);
    return sample;
  }

  void detect(int row, double y, const std::vector<Eigen::Vector3d>& directions,
              const std::vector<TrueSample>& truth, RowBuffer* out) const {
    const std::size_t cols = truth.size();
    Random random(seed_for(seed_, static_cast<std::uint64_t>(row)));
    const auto reach = static_cast<std::size_t>(std::max(0.0, std::ceil(2.5 * options_.speckle_length)));
    std::vector<double> white(cols + 2 * reach);
    for (double& w : white) {
      w = random.normal();
    }
    const std::vector<double> speckle = correlated(white, options_.speckle_length);
    const double share = std::clamp(options_.speckle_share, 0.0, 1.0);
    for (std::size_t c = 0; c < cols; ++c) {
      // The same number of draws for every cell, so that what one cell sees never shifts another's noise.
      const double noise = random.normal();
      const double lost = random.uniform();
      const double stray = random.uniform();
      const double stray_mm = random.uniform(-1.0, 1.0);
      const double mix = random.uniform();
      const double mix_share = random.uniform();
      const TrueSample& sample = truth[c];
      const double signal = sample.albedo * sample.cosine_laser;
      const double dark =
          1.0 / (1.0 + std::exp((signal - options_.dark_signal) / (0.2 * options_.dark_signal + 1e-9)));
      if (!sample.seen || lost < dark + options_.dropout) {
        out->valid[c] = 0;
        continue;
      }
      double distance = sample.distance_mm;
      if (mix < options_.mixed_pixel) {
        distance += mix_share * step_to_neighbour(truth, c);
      }
      if (stray < options_.outlier) {
        distance += 0.15 * options_.depth_range_mm * stray_mm;
      }
      const double sigma =
          options_.noise_mm *
          (1.0 + options_.incidence_gain * (1.0 / std::max(sample.cosine, options_.grazing_cosine) - 1.0));
      distance += sigma * (std::sqrt(1.0 - share) * noise + std::sqrt(share) * speckle[c]);
      write(c, y, directions[c], distance, out);
      out->intensity[c] = static_cast<float>(
          std::clamp(sample.albedo * std::sqrt(sample.cosine_laser) * (1.0 + 0.12 * speckle[c]), 0.0, 1.0));
    }
  }

  /// From a sample at a depth edge to the other side of it, along the ray; 0 elsewhere.
  double step_to_neighbour(const std::vector<TrueSample>& truth, std::size_t c) const {
    double step = 0;
    for (const std::size_t other : {c == 0 ? c : c - 1, c + 1 == truth.size() ? c : c + 1}) {
      const double gap = truth[other].distance_mm - truth[c].distance_mm;
      if (truth[other].seen && std::abs(gap) > kDepthEdge * layout_.spacing_mm &&
          std::abs(gap) > std::abs(step)) {
        step = gap;
      }
    }
    return step;
  }

  void write(std::size_t c, double y, const Eigen::Vector3d& direction, double distance,
             RowBuffer* out) const {
    double z = options_.standoff_mm + distance * direction.z();
    if (options_.quantum_mm > 0) {
      z = std::round(z / options_.quantum_mm) * options_.quantum_mm;
    }
    const double along = (z - options_.standoff_mm) / direction.z();
    out->x[c] = static_cast<float>(along * direction.x());
    out->y[c] = static_cast<float>(y);
    out->z[c] = static_cast<float>(z);
    out->valid[c] = std::abs(z) <= 0.5 * options_.depth_range_mm ? 1 : 0;
  }

  const ScannerOptions& options_;
  const Scene& scene_;
  const RigidTransform& pose_;
  const ScanLayout& layout_;
  std::uint64_t seed_;
};

/// Grows a rectangle in the plane z = 0 by one point of the scene.
struct Bounds {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity());
};

}  // namespace

ScannerOptions scanner_for(const Eigen::Vector3d& size_mm, double spacing_mm, double noise_mm) {
  // Room for a hand that puts the tablet down 5 mm off.
  constexpr double kSlipMm = 10;
  ScannerOptions options;
  options.spacing_mm = spacing_mm;
  options.noise_mm = noise_mm;
  const double need = size_mm.norm() + kSlipMm;
  const double grow = std::max(1.0, need / options.field_x_mm);
  options.standoff_mm *= grow;
  options.baseline_mm *= grow;
  options.field_x_mm *= grow;
  options.field_y_mm *= grow;
  options.depth_range_mm *= grow;
  return options;
}

ScannerView TriangulationScanner::rig_view() const {
  ScannerView view;
  view.laser_mm = Eigen::Vector3d(0, 0, options_.standoff_mm);
  view.camera_mm = Eigen::Vector3d(0, options_.baseline_mm, options_.standoff_mm);
  view.motion_per_row_mm = Eigen::Vector3d(0, options_.spacing_mm, 0);
  return view;
}

ScanLayout TriangulationScanner::layout(const Scene& scene, const RigidTransform& tablet_from_scanner) const {
  const RigidTransform scanner_from_tablet = tablet_from_scanner.inverse();
  Bounds bounds;
  const auto grow = [&](const Eigen::Vector3d& tablet_point) {
    const Eigen::Vector3d p = scanner_from_tablet * tablet_point;
    if (std::abs(p.z()) > 0.5 * options_.depth_range_mm + options_.margin_mm) {
      return;
    }
    // The fan takes x at depth z through the plane z = 0 at x·H/(H - z).
    const double fan = options_.standoff_mm / (options_.standoff_mm - p.z());
    bounds.low = bounds.low.cwiseMin(Eigen::Vector2d(p.x() * fan, p.y()));
    bounds.high = bounds.high.cwiseMax(Eigen::Vector2d(p.x() * fan, p.y()));
  };
  const auto& positions = scene.tablet->mesh.positions;
  const std::size_t stride = std::max<std::size_t>(1, positions.size() / 40000);
  for (std::size_t i = 0; i < positions.size(); i += stride) {
    grow(positions[i].cast<double>());
  }
  for (const Pin& pin : scene.pins) {
    grow(pin.tip_mm);
  }
  ScanLayout layout;
  layout.spacing_mm = options_.spacing_mm;
  layout.view = rig_view();
  if (!(bounds.low.x() <= bounds.high.x())) {
    return layout;
  }
  const Eigen::Vector2d half(0.5 * options_.field_x_mm, 0.5 * options_.field_y_mm);
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(options_.margin_mm);
  const Eigen::Vector2d low = (bounds.low - margin).cwiseMax(-half);
  const Eigen::Vector2d high = (bounds.high + margin).cwiseMin(half);
  // Columns and rows keep their places in the field whatever part of it is scanned.
  const Eigen::Vector2d first = ((low + half) / options_.spacing_mm).array().ceil().matrix();
  const Eigen::Vector2d last = ((high + half) / options_.spacing_mm).array().floor().matrix();
  if (first.x() > last.x() || first.y() > last.y()) {
    return layout;
  }
  layout.cols = static_cast<int>(last.x() - first.x()) + 1;
  layout.rows = static_cast<int>(last.y() - first.y()) + 1;
  layout.first_x_mm = first.x() * options_.spacing_mm - half.x();
  layout.first_y_mm = first.y() * options_.spacing_mm - half.y();
  layout.view.laser_mm->y() += layout.first_y_mm;
  layout.view.camera_mm->y() += layout.first_y_mm;
  return layout;
}

Status TriangulationScanner::scan(const Scene& scene, const RigidTransform& tablet_from_scanner,
                                  std::uint64_t scan_number, const RowSink& sink, JobContext& job) const {
  const ScanLayout plan = layout(scene, tablet_from_scanner);
  const RowScanner rows(options_, scene, tablet_from_scanner, plan, seed_for(options_.seed, scan_number));
  std::vector<RowBuffer> block(kRowsPerBlock, RowBuffer(static_cast<std::size_t>(plan.cols)));
  for (int first = 0; first < plan.rows; first += kRowsPerBlock) {
    const int count = std::min(kRowsPerBlock, plan.rows - first);
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "stopped while scanning");
    }
    parallel_for_each_index(
        static_cast<std::size_t>(count),
        [&](std::size_t i) { rows.scan(first + static_cast<int>(i), &block[i]); }, 1);
    for (int i = 0; i < count; ++i) {
      const RowBuffer& row = block[static_cast<std::size_t>(i)];
      if (!sink({first + i, row.x, row.y, row.z, row.intensity, row.valid})) {
        return fail(ErrorKind::kCancelled, "stopped while scanning");
      }
    }
    job.progress("scan", static_cast<double>(first + count) / plan.rows);
  }
  return {};
}

RangeGrid grid_of(const ScanLayout& layout) {
  RangeGrid grid;
  grid.allocate(layout.rows, layout.cols);
  grid.intensity.assign(grid.size(), 0.0F);
  grid.spacing_mm = layout.spacing_mm;
  grid.view = layout.view;
  grid.device = "sim";
  return grid;
}

Result<RangeGrid> TriangulationScanner::scan_grid(const Scene& scene,
                                                  const RigidTransform& tablet_from_scanner,
                                                  std::uint64_t scan_number, JobContext& job) const {
  RangeGrid grid = grid_of(layout(scene, tablet_from_scanner));
  const Status done = scan(
      scene, tablet_from_scanner, scan_number,
      [&](const ProfileRow& row) {
        const auto at = static_cast<std::ptrdiff_t>(grid.index(row.row, 0));
        std::ranges::copy(row.x, grid.x.begin() + at);
        std::ranges::copy(row.y, grid.y.begin() + at);
        std::ranges::copy(row.z, grid.z.begin() + at);
        std::ranges::copy(row.valid, grid.valid.begin() + at);
        std::ranges::copy(row.intensity, grid.intensity.begin() + at);
        return true;
      },
      job);
  if (!done) {
    return std::unexpected(done.error());
  }
  if (scene.pins.empty()) {
    return grid;
  }
  grid.pin_tip_diameter_mm = 2.0 * scene.pins.front().tip_radius_mm;
  return grid;
}

}  // namespace dubsar::sim
