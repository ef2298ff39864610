// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/ring_descriptor.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/parallel.h"
#include "core/units.h"

namespace dubsar {

namespace {

constexpr int kRings = RingDescriptors::kRings;
constexpr int kSectors = RingDescriptors::kSectors;
constexpr int kHarmonics = RingDescriptors::kHarmonics;

/// Steeper (cosine against the frame's normal) a surface is not gone on along.
constexpr float kLeastUp = 0.3F;

/// Plane through the samples within radius_mm of p, oriented like `hint`. Nothing when they are too few.
std::optional<Eigen::Vector3f> plane_normal(const SurfaceLevel& level, const Eigen::Vector3f& p,
                                            const Eigen::Vector3f& hint, float radius_mm) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  int count = 0;
  level.lookup->for_each_near(p, radius_mm, [&](std::size_t i) {
    if ((level.grid.point(i) - p).squaredNorm() <= radius_mm * radius_mm &&
        level.normals[i].dot(hint) > 0.3F) {
      sum += level.normals[i];
      ++count;
    }
  });
  if (count < 5 || sum.norm() < 1e-3F) {
    return std::nullopt;
  }
  return sum.normalized();
}

/// Of a surface with this normal over the frame's plane; flat where it is too steep to go on along it.
Eigen::Vector2f slope(const Eigen::Vector3f& normal, const RingFrame& frame) {
  const float up = normal.dot(frame.normal);
  return up < kLeastUp ? Eigen::Vector2f::Zero()
                       : Eigen::Vector2f(-normal.dot(frame.u) / up, -normal.dot(frame.v) / up);
}

/// What is read of the samples around a keypoint.
struct Reading {
  const ScanSurface& surface;
  const RingFrame& frame;
  const std::vector<float>* values;  ///< of the samples; null: their heights over the frame

  /// NaN where it is not known.
  [[nodiscard]] float at(const RingSurroundings::Place& place) const {
    return values != nullptr ? (*values)[place.sample] : place.height_mm;
  }
  /// How it changes with the place in the plane.
  [[nodiscard]] Eigen::Vector2f slope_at(const RingSurroundings::Place& place) const {
    return values != nullptr ? Eigen::Vector2f::Zero() : slope(surface.medium->normals[place.sample], frame);
  }
  /// What lies in the middle of a cell between the samples beside it; nothing when there are none.
  [[nodiscard]] std::optional<float> between(RingSurroundings& around, std::size_t cell) const {
    float total = 0;
    float weights = 0;
    for (const RingSurroundings::Beside& beside : around.beside(cell)) {
      const RingSurroundings::Place& place = around.places()[beside.place];
      const float value = at(place);
      if (!std::isnan(value)) {
        total += beside.weight * (value + slope_at(place).dot(beside.to_middle));
        weights += beside.weight;
      }
    }
    return weights > 0 ? std::optional<float>(total / weights) : std::nullopt;
  }
};

/// Mean heights in rings × sectors, nothing when too much is missing: over the tangent plane in units of the
/// radius, or of what is on it in units of its rms.
std::optional<RingHeights> ring_heights(const ScanSurface& surface, RingContent content,
                                        const RingFrame& frame, RingSurroundings& around, float radius_mm,
                                        double least_filled) {
  const Reading reading{surface, frame,
                        content == RingContent::kRelief ? &surface.relief.height_mm
                        : content == RingContent::kTone ? &surface.relief.tone
                                                        : nullptr};
  const double rms = content == RingContent::kTone ? surface.relief.tone_rms : surface.relief.rms_mm;
  const float unit = reading.values != nullptr ? std::max(static_cast<float>(rms), 1e-6F) : radius_mm;
  RingHeights sum{};
  std::array<int, RingSurroundings::kCells> count{};
  for (const RingSurroundings::Place& place : around.places()) {
    const float value = reading.at(place);
    if (!std::isnan(value)) {
      sum[place.cell] += value;
      ++count[place.cell];
    }
  }
  int filled = 0;
  int expected = 0;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int sector = 0; sector < kSectors; ++sector) {
      const auto cell = static_cast<std::size_t>(ring * kSectors + sector);
      if (count[cell] == 0) {
        if (const std::optional<float> value = reading.between(around, cell)) {
          sum[cell] = *value;
          count[cell] = 1;
        }
      }
      // The innermost sectors are narrower than the sample spacing.
      expected += ring == 0 ? 0 : 1;
      filled += ring > 0 && count[cell] > 0 ? 1 : 0;
      sum[cell] = count[cell] > 0 ? sum[cell] / (static_cast<float>(count[cell]) * unit) : 0.0F;
    }
  }
  if (filled < least_filled * expected) {
    return std::nullopt;
  }
  for (int ring = 0; ring < kRings; ++ring) {  // fill the gaps with the nearest filled sector of the ring
    for (int sector = 0; sector < kSectors; ++sector) {
      const auto cell = static_cast<std::size_t>(ring * kSectors + sector);
      for (int away = 1; count[cell] == 0 && away <= kSectors / 2; ++away) {
        for (const int side : {away, kSectors - away}) {
          const auto other = static_cast<std::size_t>(ring * kSectors + (sector + side) % kSectors);
          if (count[other] > 0) {
            sum[cell] = sum[other];
            away = kSectors;
            break;
          }
        }
      }
    }
  }
  return sum;
}

/// The sectors' angles and the Fourier basis on them, once.
struct Basis {
  std::array<std::array<std::complex<float>, kSectors>, kHarmonics> wave;
  Basis() {
    for (int k = 0; k < kHarmonics; ++k) {
      for (int s = 0; s < kSectors; ++s) {
        const double angle = 2 * kPi * (s + 0.5) / kSectors - kPi;
        wave[static_cast<std::size_t>(k)][static_cast<std::size_t>(s)] =
            std::complex<float>(static_cast<float>(std::cos(k * angle) / kSectors),
                                static_cast<float>(-std::sin(k * angle) / kSectors));
      }
    }
  }
};

}  // namespace

std::vector<RingDescriptors> RingDescriptors::make(const ScanSurface& surface, double scale_mm,
                                                   std::span<const RingContent> contents,
                                                   const RingDescriptorOptions& options) {
  const SurfaceLevel& level = *surface.medium;
  std::vector<std::uint32_t> usable;
  for (std::size_t i = 0; i < level.usable.size(); ++i) {
    if (level.usable[i] != 0) {
      usable.push_back(static_cast<std::uint32_t>(i));
    }
  }
  const std::size_t wanted = std::min(usable.size(), static_cast<std::size_t>(options.keypoints));
  struct Candidate {
    SurfaceSample keypoint;
    Eigen::Vector3f tangent;
    std::vector<std::optional<Coefficients>> of_content;
  };
  std::vector<Candidate> candidates(wanted);
  parallel_chunks(wanted, 16, [&](std::size_t begin, std::size_t end) {
    RingSurroundings around;
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t i = usable[(2 * k + 1) * usable.size() / (2 * wanted)];
      const auto inner = static_cast<float>(options.radius[0] * scale_mm);
      const std::optional<Eigen::Vector3f> normal =
          plane_normal(level, level.grid.point(i), level.normals[i], 0.6F * inner);
      if (!normal) {
        continue;
      }
      RingFrame frame{level.grid.point(i), *normal, normal->unitOrthogonal(), {}};
      frame.v = frame.normal.cross(frame.u);
      Candidate& candidate = candidates[k];
      candidate.keypoint = {frame.origin, frame.normal, 1.0F};
      candidate.tangent = frame.u;
      candidate.of_content.assign(contents.size(), Coefficients{});
      for (int s = 0; s < kScales; ++s) {
        const auto radius = static_cast<float>(options.radius[static_cast<std::size_t>(s)] * scale_mm);
        around.look(level, frame, radius);
        for (std::size_t c = 0; c < contents.size(); ++c) {
          std::optional<Coefficients>& out = candidate.of_content[c];
          const std::optional<RingHeights> heights =
              out ? ring_heights(surface, contents[c], frame, around, radius, options.least_filled)
                  : std::nullopt;
          if (heights) {
            set_scale(*out, s, *heights);
          } else {
            out.reset();
          }
        }
      }
    }
  });
  std::vector<RingDescriptors> out(contents.size());
  for (std::size_t c = 0; c < contents.size(); ++c) {
    for (const Candidate& candidate : candidates) {  // nothing of one without a plane
      if (!candidate.of_content.empty() && candidate.of_content[c]) {
        out[c].keypoints_.push_back(candidate.keypoint);
        out[c].tangents_.push_back(candidate.tangent);
        out[c].coefficients_.push_back(*candidate.of_content[c]);
      }
    }
    out[c].set_magnitudes();
  }
  return out;
}

void RingDescriptors::set_scale(Coefficients& coefficients, int scale, const RingHeights& heights) {
  static const Basis basis;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int h = 0; h < kHarmonics; ++h) {
      std::complex<float> sum = 0;
      for (int sector = 0; sector < kSectors; ++sector) {
        sum += heights[static_cast<std::size_t>(ring * kSectors + sector)] *
               basis.wave[static_cast<std::size_t>(h)][static_cast<std::size_t>(sector)];
      }
      coefficients[static_cast<std::size_t>((scale * kRings + ring) * kHarmonics + h)] = sum;
    }
  }
}

void RingDescriptors::set_magnitudes() {
  magnitudes_.resize(kLength, static_cast<Eigen::Index>(keypoints_.size()));
  for (std::size_t k = 0; k < keypoints_.size(); ++k) {
    for (int c = 0; c < kLength; ++c) {
      const std::complex<float> value = coefficients_[k][static_cast<std::size_t>(c)];
      // The mean height has a sign that tells hollows from bumps; a harmonic's own sign is a turn.
      magnitudes_(c, static_cast<Eigen::Index>(k)) =
          c % kHarmonics == 0 ? value.real() : 1.4142F * std::abs(value);
    }
  }
}

std::vector<RingDescriptors::Match> RingDescriptors::match(const RingDescriptors& source,
                                                           const RingDescriptors& target,
                                                           const RingDescriptorOptions& options) {
  std::vector<Match> out;
  if (source.size() == 0 || target.size() == 0) {
    return out;
  }
  const Eigen::VectorXf target_norm2 = target.magnitudes_.colwise().squaredNorm();
  const Eigen::MatrixXf dots = target.magnitudes_.transpose() * source.magnitudes_;
  const int keep = std::min(options.matches_per_keypoint, static_cast<int>(target.size()));
  for (Eigen::Index s = 0; s < dots.cols(); ++s) {
    std::array<std::pair<float, int>, 8> best;
    best.fill({std::numeric_limits<float>::max(), -1});
    const float own = source.magnitudes_.col(s).squaredNorm();
    for (Eigen::Index t = 0; t < dots.rows(); ++t) {
      std::pair<float, int> entry{own + target_norm2[t] - 2 * dots(t, s), static_cast<int>(t)};
      for (int k = 0; k < keep && k < static_cast<int>(best.size()); ++k) {
        if (entry.first < best[static_cast<std::size_t>(k)].first) {
          std::swap(entry, best[static_cast<std::size_t>(k)]);
        }
      }
    }
    for (int k = 0; k < keep && k < static_cast<int>(best.size()); ++k) {
      const auto& [d2, t] = best[static_cast<std::size_t>(k)];
      if (t >= 0) {
        // Flat places resemble all flat places: what counts is the distance against the shape's own strength.
        out.push_back(
            {static_cast<int>(s), t, std::sqrt(std::max(d2, 0.0F) / (own + target_norm2[t] + 1e-6F))});
      }
    }
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Match& a, const Match& b) { return a.distance < b.distance; });
  return out;
}

RigidTransform RingDescriptors::pose_of(const RingDescriptors& source, const RingDescriptors& target,
                                        const Match& m) {
  const auto s = static_cast<std::size_t>(m.source);
  const auto t = static_cast<std::size_t>(m.target);
  // A turn by theta multiplies harmonic k by exp(-i k theta): correlate over all turns.
  std::array<std::complex<float>, kHarmonics> product{};
  for (int scale = 0; scale < kScales; ++scale) {
    for (int ring = 0; ring < kRings; ++ring) {
      for (int h = 1; h < kHarmonics; ++h) {
        const auto c = static_cast<std::size_t>((scale * kRings + ring) * kHarmonics + h);
        // Outer rings hold more surface.
        product[static_cast<std::size_t>(h)] +=
            static_cast<float>(ring + 1) * source.coefficients_[s][c] * std::conj(target.coefficients_[t][c]);
      }
    }
  }
  constexpr int kTurns = 72;
  float best = -std::numeric_limits<float>::max();
  double turn = 0;
  for (int k = 0; k < kTurns; ++k) {
    const double theta = 2 * kPi * k / kTurns;
    float value = 0;
    for (int h = 1; h < kHarmonics; ++h) {
      const std::complex<float> wave(static_cast<float>(std::cos(h * theta)),
                                     static_cast<float>(-std::sin(h * theta)));
      value += (product[static_cast<std::size_t>(h)] * wave).real();
    }
    if (value > best) {
      best = value;
      turn = theta;
    }
  }
  const auto basis = [](const Eigen::Vector3f& normal, const Eigen::Vector3f& tangent) {
    Eigen::Matrix3d b;
    const Eigen::Vector3d n = normal.cast<double>();
    const Eigen::Vector3d u = tangent.cast<double>();
    b << u, n.cross(u), n;
    return b;
  };
  const Eigen::Matrix3d from = basis(source.keypoints_[s].normal, source.tangents_[s]);
  const Eigen::Matrix3d to = basis(target.keypoints_[t].normal, target.tangents_[t]);
  RigidTransform out;
  out.rotation = to * Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix() * from.transpose();
  out = out.orthonormalised();
  out.translation_mm = target.keypoints_[t].position_mm.cast<double>() -
                       out.rotation * source.keypoints_[s].position_mm.cast<double>();
  return out;
}

}  // namespace dubsar
