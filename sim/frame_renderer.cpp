// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Speckle: J. W. Goodman, Speckle Phenomena in Optics, 2007, chapters 2 and 4. Its effect on a stripe:
// Dorsch, Haeusler and Herrmann, Laser triangulation: fundamental uncertainty in distance measurement, 1994.
#include "sim/frame_renderer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "core/random.h"
#include "core/units.h"

namespace dubsar::sim {

namespace {

constexpr int kSub = 2;              // samples per pixel side where the laser shines
constexpr int kFanPerColumn = 3;     // laser rays per image column
constexpr double kSheetReach = 3.5;  // standard deviations of the sheet that are traced
constexpr double kAlbedo = 0.5;      // that the signals of the options are said of

struct Fan {
  Eigen::Vector3d source_mm;
  Eigen::Vector3d middle;  // unit, towards the middle of the volume
  Eigen::Vector3d side;    // unit, in the plane
  double half_width = 0;   // tangent of half the fan
  int count = 0;
  [[nodiscard]] Eigen::Vector3d direction(int i) const {
    return (middle + half_width * (2.0 * (i + 0.5) / count - 1) * side).normalized();
  }
};

Fan fan_of(const RigCalibration& truth, const Plane& plane) {
  Fan fan;
  const Eigen::Vector3d source = truth.laser_source_mm.value_or(Eigen::Vector3d::Zero());
  fan.source_mm = source - plane.signed_distance_mm(source) * plane.normal;
  const double reach =
      plane.along(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ()).value_or(truth.working_distance_mm);
  fan.middle = (Eigen::Vector3d(0, 0, reach) - fan.source_mm).normalized();
  fan.side = plane.normal.cross(fan.middle).normalized();
  // A quarter more than the camera's field where it is widest in the volume.
  const double half_field = 0.5 * truth.camera.width / truth.camera.fx_px * reach * 1.25;
  fan.half_width = half_field / (Eigen::Vector3d(0, 0, reach) - fan.source_mm).norm();
  fan.count = truth.camera.width * kFanPerColumn * 5 / 4;
  return fan;
}

}  // namespace

/// The samples around the stripe: all of them in one dense array, and which pixels are worth a look.
struct FrameRenderer::Band {
  int width = 0;                  // pixels
  int height = 0;                 // pixels
  std::vector<std::uint8_t> lit;  // [pixels] 1 where laser light may be seen
  std::vector<float> energy;      // [kSub² per pixel] what the sensor would get without any blur
  [[nodiscard]] std::size_t sample(int su, int sv) const {
    return static_cast<std::size_t>(sv) * static_cast<std::size_t>(width * kSub) +
           static_cast<std::size_t>(su);
  }
  void mark(const Eigen::Vector2d& at, int around_u, int around_v) {
    const int u = static_cast<int>(std::lround(at.x()));
    const int v = static_cast<int>(std::lround(at.y()));
    for (int y = std::max(0, v - around_v); y <= std::min(height - 1, v + around_v); ++y) {
      for (int x = std::max(0, u - around_u); x <= std::min(width - 1, u + around_u); ++x) {
        lit[static_cast<std::size_t>(y * width + x)] = 1;
      }
    }
  }
};

FrameRenderer::FrameRenderer(const RigCalibration& truth, const FrameOptions& options)
    : truth_(truth), options_(options) {
  const double reach = truth.laser.along(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ())
                           .value_or(truth.working_distance_mm);
  const double magnification = truth.camera.fx_px * options.pixel_um * 1e-3 / reach;
  spread_ = point_spread(options.wavelength_um * options.f_number * (1 + magnification),
                         options.pixel_um / kSub, options.defocus_waves);
}

Eigen::Vector3d FrameRenderer::ray_through(double u, double v) const {
  const std::optional<Eigen::Vector2d> n = truth_.camera.undistort({u, v});
  return n ? Eigen::Vector3d(n->x(), n->y(), 1).normalized() : Eigen::Vector3d(0, 0, -1);
}

FrameRenderer::Band FrameRenderer::lit_band(const FrameTarget& target, const Plane& plane) const {
  Band band;
  band.width = truth_.camera.width;
  band.height = truth_.camera.height;
  band.lit.assign(static_cast<std::size_t>(band.width) * static_cast<std::size_t>(band.height), 0);
  band.energy.assign(band.lit.size() * kSub * kSub, 0.0F);
  const Fan fan = fan_of(truth_, plane);
  const double px_per_mm = 1.0 / truth_.field_per_px_mm();
  const int blur = spread_.radius / kSub + 1;
  const int around = blur + static_cast<int>(std::ceil(kSheetReach * options_.laser_sigma_mm * px_per_mm));
  // The sheet's two sides as well, which may light what its middle misses behind an edge.
  constexpr std::array kSides{-2.0, 0.0, 2.0};
  struct Spot {
    Eigen::Vector2d pixel{-1, -1};
    Eigen::Vector2d second{-1, -1};  // where it goes on to from a glossy surface
    double second_energy = 0;
  };
  std::vector<Spot> spots(static_cast<std::size_t>(fan.count) * kSides.size());
  parallel_for_each_index(spots.size(), [&](std::size_t i) {
    const double off = kSides[i % kSides.size()] * options_.laser_sigma_mm;
    const Eigen::Vector3d direction = fan.direction(static_cast<int>(i / kSides.size()));
    const Eigen::Vector3d from = fan.source_mm + off * plane.normal;
    const std::optional<SceneHit> hit = target.hit(from, direction);
    if (!hit) {
      return;
    }
    const Eigen::Vector3d p = from + hit->distance_mm * direction;
    if (!(p.z() > 0)) {
      return;
    }
    spots[i].pixel = truth_.camera.project(p);
    if (options_.gloss > 0 && off == 0) {
      const Eigen::Vector3d on = direction - 2 * direction.dot(hit->normal) * hit->normal;
      const Eigen::Vector3d start = p + 0.02 * on;
      const std::optional<SceneHit> second = target.hit(start, on);
      if (second) {
        const Eigen::Vector3d q = start + second->distance_mm * on;
        if (q.z() > 0 && !target.blocked(q, Eigen::Vector3d::Zero())) {
          spots[i].second = truth_.camera.project(q);
          spots[i].second_energy = options_.gloss * options_.laser_signal * (second->albedo / kAlbedo) *
                                   std::max(0.0, -on.dot(second->normal));
        }
      }
    }
  });
  const double sigma = options_.laser_sigma_mm * px_per_mm;
  for (const Spot& spot : spots) {
    band.mark(spot.pixel, blur + 1, around);
    if (spot.second_energy > 0 && truth_.camera.sees(spot.second, around + 1.0)) {
      band.mark(spot.second, blur + 1, around);
      const int su = static_cast<int>(std::lround(spot.second.x() * kSub));
      for (int sv = static_cast<int>((spot.second.y() - 3 * sigma) * kSub);
           sv <= static_cast<int>((spot.second.y() + 3 * sigma) * kSub); ++sv) {
        const double d = (sv + 0.5) / kSub - 0.5 - spot.second.y();
        band.energy[band.sample(su, sv)] += static_cast<float>(spot.second_energy * kSub / kFanPerColumn *
                                                               std::exp(-d * d / (2 * sigma * sigma)));
      }
    }
  }
  return band;
}

void FrameRenderer::light(const FrameTarget& target, const Plane& plane, Band& band) const {
  const Fan fan = fan_of(truth_, plane);
  const double sigma = options_.laser_sigma_mm;
  parallel_for_each_index(
      static_cast<std::size_t>(band.height),
      [&](std::size_t row) {
        for (int u = 0; u < band.width; ++u) {
          if (band.lit[row * static_cast<std::size_t>(band.width) + static_cast<std::size_t>(u)] == 0) {
            continue;
          }
          for (int k = 0; k < kSub * kSub; ++k) {
            const int su = u * kSub + k % kSub;
            const int sv = static_cast<int>(row) * kSub + k / kSub;
            const Eigen::Vector3d ray = ray_through((su + 0.5) / kSub - 0.5, (sv + 0.5) / kSub - 0.5);
            const std::optional<SceneHit> hit = target.hit(Eigen::Vector3d::Zero(), ray);
            if (!hit || !(hit->albedo > 0)) {
              continue;
            }
            const Eigen::Vector3d p = hit->distance_mm * ray;
            const double off = plane.signed_distance_mm(p);
            if (std::abs(off) > kSheetReach * sigma) {
              continue;
            }
            const Eigen::Vector3d source = fan.source_mm + off * plane.normal;
            const double facing = (source - p).normalized().dot(hit->normal);
            if (facing > 0 && !target.blocked(p, source)) {
              band.energy[band.sample(su, sv)] +=
                  static_cast<float>(options_.laser_signal * (hit->albedo / kAlbedo) * facing *
                                     std::exp(-off * off / (2 * sigma * sigma)));
            }
          }
        }
      },
      4);
}

void FrameRenderer::image(const Band& band, std::uint64_t frame, std::vector<float>& signal) const {
  const int width = band.width * kSub;
  const int height = band.height * kSub;
  const auto contrast = static_cast<float>(options_.speckle_contrast);
  std::vector<std::complex<float>> field;
  if (contrast > 0) {
    field.assign(band.energy.size(), 0.0F);
    parallel_for_each_index(
        static_cast<std::size_t>(height),
        [&](std::size_t sv) {
          Random random(seed_for(options_.seed ^ (frame << 20U), sv));
          for (int su = 0; su < width; ++su) {
            const std::size_t i = band.sample(su, static_cast<int>(sv));
            if (band.energy[i] > 0) {
              field[i] =
                  std::polar(std::sqrt(band.energy[i]), static_cast<float>(2 * kPi * random.uniform()));
            }
          }
        },
        4);
  }
  const int r = spread_.radius;
  std::vector<float> power;
  for (const std::complex<float>& h : spread_.amplitude) {
    power.push_back(std::norm(h));
  }
  parallel_for_each_index(
      static_cast<std::size_t>(band.height),
      [&](std::size_t row) {
        for (int u = 0; u < band.width; ++u) {
          const std::size_t pixel = row * static_cast<std::size_t>(band.width) + static_cast<std::size_t>(u);
          if (band.lit[pixel] == 0) {
            continue;
          }
          float sum = 0;
          for (int k = 0; k < kSub * kSub; ++k) {
            const int su = u * kSub + k % kSub;
            const int sv = static_cast<int>(row) * kSub + k / kSub;
            std::complex<float> amplitude = 0;
            float mean = 0;
            for (int y = std::max(0, sv - r); y <= std::min(height - 1, sv + r); ++y) {
              for (int x = std::max(0, su - r); x <= std::min(width - 1, su + r); ++x) {
                const std::size_t from = band.sample(x, y);
                if (band.energy[from] > 0) {
                  const auto tap = static_cast<std::size_t>((sv - y + r) * spread_.side() + su - x + r);
                  mean += power[tap] * band.energy[from];
                  if (contrast > 0) {
                    const std::complex<float> h = spread_.amplitude[tap];
                    const std::complex<float> a = field[from];
                    amplitude += std::complex<float>(h.real() * a.real() - h.imag() * a.imag(),
                                                     h.real() * a.imag() + h.imag() * a.real());
                  }
                }
              }
            }
            sum += contrast * std::norm(amplitude) + (1 - contrast) * mean;
          }
          signal[pixel] += sum / (kSub * kSub);
        }
      },
      4);
}

GrayImage FrameRenderer::render(const FrameTarget& target, bool laser_on, double position,
                                std::uint64_t frame) const {
  GrayImage out(truth_.camera.width, truth_.camera.height);
  std::vector<float> signal(out.pixels.size(), 0.0F);
  if (options_.ambient_signal > 0) {
    signal = ambient(target);
  }
  if (laser_on) {
    const Plane plane = truth_.motion.laser_at(truth_.laser, position);
    Band band = lit_band(target, plane);
    light(target, plane, band);
    image(band, frame, signal);
  }
  const double well = options_.full_well_electrons;
  const auto width = static_cast<std::size_t>(out.width);
  parallel_for_each_index(
      static_cast<std::size_t>(out.height),
      [&](std::size_t row) {
        Random random(seed_for(options_.seed * 3 + 1 + (frame << 24U), row));
        for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
          const double electrons = std::max(0.0, static_cast<double>(signal[i])) * well;
          const double noisy =
              electrons + random.normal() * std::sqrt(electrons + options_.read_noise_electrons *
                                                                      options_.read_noise_electrons);
          const double grey = std::round(options_.black_level + 255.0 * std::min(noisy, well) / well);
          out.pixels[i] = static_cast<std::uint8_t>(std::clamp(grey, 0.0, 255.0));
        }
      },
      8);
  return out;
}

std::vector<double> FrameRenderer::true_rows(const FrameTarget& target, double position) const {
  const Plane plane = truth_.motion.laser_at(truth_.laser, position);
  const Fan fan = fan_of(truth_, plane);
  const auto width = static_cast<std::size_t>(truth_.camera.width);
  std::vector<Eigen::Vector2d> seen(static_cast<std::size_t>(fan.count), Eigen::Vector2d(-1, -1));
  parallel_for_each_index(seen.size(), [&](std::size_t i) {
    const Eigen::Vector3d direction = fan.direction(static_cast<int>(i));
    const std::optional<SceneHit> hit = target.hit(fan.source_mm, direction);
    if (!hit) {
      return;
    }
    const Eigen::Vector3d p = fan.source_mm + hit->distance_mm * direction;
    if (p.z() > 0 && !target.blocked(p, Eigen::Vector3d::Zero())) {
      seen[i] = truth_.camera.project(p);
    }
  });
  std::vector<double> rows(width, std::numeric_limits<double>::quiet_NaN());
  std::vector<std::uint8_t> crossed(width, 0);
  for (std::size_t i = 1; i < seen.size(); ++i) {
    const Eigen::Vector2d& a = seen[i - 1];
    const Eigen::Vector2d& b = seen[i];
    if (a.x() < 0 || b.x() < 0 || (a - b).norm() > 3) {
      continue;
    }
    const double low = std::min(a.x(), b.x());
    const double high = std::max(a.x(), b.x());
    for (int u = static_cast<int>(std::ceil(low)); u < high && u < truth_.camera.width; ++u) {
      const double t = (u - a.x()) / (b.x() - a.x());
      auto& times = crossed[static_cast<std::size_t>(u)];
      times = static_cast<std::uint8_t>(std::min(2, times + 1));
      rows[static_cast<std::size_t>(u)] =
          times == 1 ? a.y() + t * (b.y() - a.y()) : std::numeric_limits<double>::quiet_NaN();
    }
  }
  return rows;
}

}  // namespace dubsar::sim
