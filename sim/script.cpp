// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/script.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/signs.h"

namespace dubsar::sim {

namespace {

constexpr int kRepertoire = 40;
constexpr double kSignGap = 0.14;  ///< of the line height

class Scribe {
 public:
  Scribe(const TabletBody& body, const ScriptOptions& options)
      : body_(body), options_(options), random_(seed_for(options.seed, 11)) {
    const Eigen::Vector3d& half = body.half_size_mm();
    hand_.line_height_mm =
        options.line_height_mm > 0 ? options.line_height_mm : std::clamp(2.0 * half.y() / 8.5, 3.2, 6.5);
    hand_.head_width = random_.uniform(0.25, 0.31);
    hand_.depth = random_.uniform(0.38, 0.46);
    hand_.head_slope_rad = random_.uniform(1.02, 1.13);
    hand_.slant_rad = random_.uniform(-0.06, 0.06);
    hand_.unsteadiness = random_.uniform(0.03, 0.06);
    for (int i = 0; i < kRepertoire; ++i) {
      repertoire_.push_back(make_sign(random_));
    }
  }

  std::vector<Impression> write() {
    const Eigen::Vector3d& half = body_.half_size_mm();
    // Round the tablet in the plane x = 0: down the obverse, over the lower edge, up the reverse, over the
    // upper edge. On each face the reader's right is +x, since a tablet is turned over its lower edge.
    SurfaceFrame at = body_.frame_at({0, 0, half.z()}, Eigen::Vector3d::UnitX());
    while (at.n.y() < 0.55) {
      at = body_.walk(at, 0, 0.25);
    }
    const double reverse_end = random_.uniform(0.5, 1.0) * options_.density;
    bool written_reverse = false;
    double walked = 0;
    // The last upper edge is reached when the normal points up again after the reverse.
    while (walked < 12.0 * (half.y() + half.z())) {
      const SurfaceFrame base = body_.walk(at, 0, -hand_.line_height_mm);
      walked += hand_.line_height_mm;
      const bool on_edge = std::abs(base.n.y()) > 0.8;
      const bool reverse = base.n.z() < -0.3;
      written_reverse = written_reverse || reverse;
      if (written_reverse && base.n.y() > 0.4) {
        break;
      }
      const double along_reverse = reverse ? (base.p_mm.y() + half.y()) / (2.0 * half.y()) : 0.0;
      const bool blank = (reverse && along_reverse > reverse_end) || (on_edge && !options_.edges);
      if (!blank && random_.uniform() < options_.density) {
        write_line(base);
      }
      at = base;
    }
    if (options_.edges && options_.density > 0 && random_.uniform() < 0.6) {
      write_left_edge();
    }
    return std::move(impressions_);
  }

 private:
  /// Goes left (-1) or right (1) until the surface has turned away by more than the cosine allows.
  SurfaceFrame go_until(const SurfaceFrame& line, int side, double cosine) const {
    SurfaceFrame at = line;
    const double most = 2.2 * (body_.half_size_mm().x() + body_.half_size_mm().z());
    for (double gone = 0; gone < most && at.n.dot(line.n) > cosine; gone += 0.3) {
      at = body_.walk_line(at, line, 0.3 * side);
    }
    return at;
  }

  void write_line(const SurfaceFrame& middle) {
    const SurfaceFrame at = go_until(middle, -1, 0.72);
    const bool runs_over = options_.edges && random_.uniform() < 0.35;
    const double cosine = runs_over ? -0.1 : 0.72;
    const double share = random_.uniform() < 0.15 ? random_.uniform(0.3, 0.8) : 1.0;
    write_along(at, middle, cosine, share * 2.2 * body_.half_size_mm().x() + 6.0);
  }

  void write_left_edge() {
    const Eigen::Vector3d& half = body_.half_size_mm();
    const SurfaceFrame middle = body_.frame_at({-half.x(), 0, 0}, -Eigen::Vector3d::UnitY());
    const SurfaceFrame low = body_.walk(middle, 0, -0.45 * hand_.line_height_mm);
    const SurfaceFrame start = go_until(low, -1, 0.8);
    write_along(start, low, 0.8, random_.uniform(0.4, 1.0) * 2.0 * half.y());
  }

  /// Signs from `at` on along the line while the surface still faces as the line's middle does.
  void write_along(SurfaceFrame at, const SurfaceFrame& line, double cosine, double most_mm) {
    const double unit = 0.84 * hand_.line_height_mm;
    for (double gone = 0; gone < most_mm;) {
      // Common signs are common: the square favours the front of the repertoire.
      const double pick = random_.uniform() * random_.uniform();
      const Sign& sign = repertoire_[static_cast<std::size_t>(pick * kRepertoire)];
      const double width = unit * sign.width * random_.uniform(0.95, 1.08);
      if (body_.walk_line(at, line, 0.8 * width).n.dot(line.n) < cosine) {
        return;
      }
      for (const SignStroke& stroke : sign.strokes) {
        const double dam_mm = options_.dam_mm * random_.uniform(0.7, 1.3);
        impressions_.emplace_back(body_, at, write_stroke(stroke, hand_, random_), dam_mm);
      }
      const double step = width + kSignGap * hand_.line_height_mm * random_.uniform(0.7, 1.6);
      at = body_.walk_line(at, line, step);
      gone += step;
    }
  }

  const TabletBody& body_;
  const ScriptOptions& options_;
  Random random_;
  Hand hand_;
  std::vector<Sign> repertoire_;
  std::vector<Impression> impressions_;
};

}  // namespace

std::vector<Impression> write_text(const TabletBody& body, const ScriptOptions& options) {
  if (options.density <= 0) {
    return {};
  }
  return Scribe(body, options).write();
}

}  // namespace dubsar::sim
