// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/gap_fill.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "triangulation/outer_rims.h"

namespace dubsar {

namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr double kSeenWithinSpacings = 2.5;
/// Openings with more vertices than this are outer boundaries, not gaps.
constexpr std::size_t kMostVertices = 400;

float mean_spacing_mm(const Sheet& sheet, const std::vector<std::uint32_t>& opening) {
  double sum = 0;
  for (const std::uint32_t v : opening) {
    sum += static_cast<double>(sheet.spacing_mm[v]);
  }
  return opening.empty() ? 0.0F : static_cast<float>(sum / static_cast<double>(opening.size()));
}

bool inside_polygon(const std::vector<Vector2f>& polygon, const Vector2f& p) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vector2f& a = polygon[i];
    const Vector2f& b = polygon[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x()) {
      inside = !inside;
    }
  }
  return inside;
}

/// Mean value coordinates of p for the polygon's corners (Floater 2003); they add up to 1.
std::vector<double> mean_value_coordinates(const std::vector<Vector2f>& polygon, const Vector2f& p) {
  const std::size_t n = polygon.size();
  std::vector<double> weights(n);
  double sum = 0;
  const auto half_tangent = [&](std::size_t i, std::size_t j) {
    const Vector2f a = polygon[i] - p;
    const Vector2f b = polygon[j] - p;
    const double lengths = static_cast<double>(a.norm()) * b.norm();
    const double cosine = a.dot(b) / std::max(lengths, 1e-20);
    const double sine = static_cast<double>(a.x() * b.y() - a.y() * b.x()) / std::max(lengths, 1e-20);
    return std::abs(sine) < 1e-12 ? 0.0 : (1.0 - cosine) / sine;
  };
  for (std::size_t i = 0; i < n; ++i) {
    const double r = std::max<double>((polygon[i] - p).norm(), 1e-9);
    weights[i] = (half_tangent((i + n - 1) % n, i) + half_tangent(i, (i + 1) % n)) / r;
    sum += weights[i];
  }
  for (double& weight : weights) {
    weight = std::abs(sum) < 1e-12 ? 1.0 / static_cast<double>(n) : weight / sum;
  }
  return weights;
}

/// What is known around an opening, in its mean plane, mm.
struct Rim {
  std::vector<Vector2f> places;
  std::vector<float> heights;
  std::vector<Vector2f> slopes;  ///< of the clay, by the normals
  std::vector<float> variances;  ///< of the heights
};

struct Interpolated {
  float height = 0;
  float sigma = 0;
};

/// Between the heights of the rim, which may all be off the same way, by the poses of scans. How far clay
/// that nobody saw lies from there is told by how it goes into the opening: where it bends evenly it lies
/// half way between the interpolated height and the planes that touch it at the rim, and at a step one of
/// these planes is right. What noise makes of a plane through samples two spacings apart is taken off.
Interpolated interpolate(const Rim& rim, const Vector2f& p, float spacing_mm) {
  constexpr double kOfBend = 0.5;
  const std::vector<double> shares = mean_value_coordinates(rim.places, p);
  double height = 0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    height += shares[i] * rim.heights[i];
  }
  double bend2 = 0, noise2 = 0, sum = 0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double share = std::abs(shares[i]);
    const Vector2f away = p - rim.places[i];
    const double off = rim.heights[i] + rim.slopes[i].dot(away) - height;
    const double steps2 = away.squaredNorm() / (spacing_mm * spacing_mm);
    bend2 += share * (off * off - 0.5 * steps2 * rim.variances[i]);
    noise2 += share * rim.variances[i];
    sum += share;
  }
  const double variance = noise2 + kOfBend * kOfBend * std::max(bend2, 0.0);
  return {static_cast<float>(height), static_cast<float>(std::sqrt(variance / std::max(sum, 1e-12)))};
}

}  // namespace

double opening_diameter_mm(const Sheet& sheet, const std::vector<std::uint32_t>& opening) {
  if (opening.size() > kMostVertices) {
    Eigen::AlignedBox3f box;
    for (const std::uint32_t v : opening) {
      box.extend(sheet.positions[v]);
    }
    return box.diagonal().norm();
  }
  float widest2 = 0;
  for (std::size_t i = 0; i < opening.size(); ++i) {
    for (std::size_t j = i + 1; j < opening.size(); ++j) {
      widest2 = std::max(widest2, (sheet.positions[opening[i]] - sheet.positions[opening[j]]).squaredNorm());
    }
  }
  return std::sqrt(widest2);
}

namespace {

/// Looked at in the middle of the opening and half way from there to each of its vertices.
bool seen_all_over(const Sheet& sheet, const std::vector<std::uint32_t>& opening, double spacing_mm,
                   const GapFillOptions& options) {
  if (!options.seen) {
    return false;
  }
  Vector3f middle = Vector3f::Zero();
  for (const std::uint32_t v : opening) {
    middle += sheet.positions[v] / static_cast<float>(opening.size());
  }
  const auto radius_mm = static_cast<float>(kSeenWithinSpacings * spacing_mm);
  return options.seen(middle, radius_mm) && std::all_of(opening.begin(), opening.end(), [&](std::uint32_t v) {
           return options.seen(0.5F * (middle + sheet.positions[v]), radius_mm);
         });
}

}  // namespace

bool is_gap(const Sheet& sheet, const std::vector<std::uint32_t>& opening, const GapFillOptions& options) {
  if (opening.size() < 3) {
    return false;
  }
  const double mu = mean_spacing_mm(sheet, opening);
  const double across_mm = opening_diameter_mm(sheet, opening);
  if (across_mm <= options.most_width_factor * mu) {
    return true;
  }
  if (opening.size() > kMostVertices) {
    return false;
  }
  Vector3f area = Vector3f::Zero();
  double length = 0;
  for (std::size_t i = 0; i < opening.size(); ++i) {
    const Vector3f& a = sheet.positions[opening[i]];
    const Vector3f& b = sheet.positions[opening[(i + 1) % opening.size()]];
    area += 0.5F * (a - sheet.positions[opening[0]]).cross(b - sheet.positions[opening[0]]);
    length += (b - a).norm();
  }
  const double width_mm = 4.0 * area.norm() / length;
  if (width_mm <= options.crack_width_factor * mu) {
    return true;
  }
  return (across_mm <= options.most_seen_width_factor * mu ||
          width_mm <= options.seen_crack_width_factor * mu) &&
         seen_all_over(sheet, opening, mu, options);
}

float gap_reach_mm(float spacing_mm, const SeamOptions& seam) {
  // The ball that a choice looks at goes 1.25 times the longest edge beyond the middle of one of up to that.
  return static_cast<float>(1.75 * seam.most_gap_edge_factor) * spacing_mm;
}

bool has_room(const Sheet& sheet, const std::vector<std::uint32_t>& opening, const SeamOptions& seam) {
  return std::all_of(opening.begin(), opening.end(), [&](std::uint32_t v) {
    return sheet.has_room(sheet.positions[v], gap_reach_mm(sheet.spacing_mm[v], seam));
  });
}

std::size_t interpolate_vertices(Front& front, const std::vector<std::uint32_t>& opening) {
  const Sheet& sheet = front.sheet();
  const float mu = mean_spacing_mm(sheet, opening);
  Vector3f centre = Vector3f::Zero();
  Vector3f normal = Vector3f::Zero();
  for (const std::uint32_t v : opening) {
    centre += sheet.positions[v];
    normal += sheet.normals[v];
  }
  centre /= static_cast<float>(opening.size());
  if (!(normal.norm() > 0.3F * static_cast<float>(opening.size())) || !(mu > 0)) {
    return 0;
  }
  normal.normalize();
  const Vector3f u = normal.unitOrthogonal();
  const Vector3f v_axis = normal.cross(u);
  constexpr float kLeastCos = 0.2F;  // steeper walls are as steep as this
  Rim rim;
  const std::vector<Vector2f>& polygon = rim.places;
  Vector2f low = Vector2f::Constant(std::numeric_limits<float>::max());
  Vector2f high = -low;
  for (const std::uint32_t v : opening) {
    const Vector3f d = sheet.positions[v] - centre;
    rim.places.emplace_back(d.dot(u), d.dot(v_axis));
    rim.heights.push_back(d.dot(normal));
    const Vector3f& n = sheet.normals[v];
    rim.slopes.push_back(-Vector2f(n.dot(u), n.dot(v_axis)) / std::max(n.dot(normal), kLeastCos));
    rim.variances.push_back(sheet.sigma_mm[v] * sheet.sigma_mm[v]);
    low = low.cwiseMin(polygon.back());
    high = high.cwiseMax(polygon.back());
  }
  const float row_mm = mu * 0.866F;
  const int rows = static_cast<int>((high.y() - low.y()) / row_mm) + 1;
  const int cols = static_cast<int>((high.x() - low.x()) / mu) + 1;
  std::size_t added = 0;
  for (int r = 0; r <= rows && rows < 200; ++r) {
    for (int c = 0; c <= cols && cols < 200; ++c) {
      const Vector2f p(low.x() + mu * (static_cast<float>(c) + ((r & 1) != 0 ? 0.5F : 0.0F)),
                       low.y() + row_mm * static_cast<float>(r));
      bool clear = true;
      for (std::size_t i = 0; i < polygon.size() && clear; ++i) {
        const Vector2f& a = polygon[i];
        const Vector2f ab = polygon[(i + 1) % polygon.size()] - a;
        const float t = std::clamp((p - a).dot(ab) / std::max(ab.squaredNorm(), 1e-20F), 0.0F, 1.0F);
        clear = (a + t * ab - p).squaredNorm() > 0.36F * mu * mu;
      }
      if (clear && inside_polygon(polygon, p)) {
        const Interpolated at = interpolate(rim, p, mu);
        front.add_vertex(centre + u * p.x() + v_axis * p.y() + normal * at.height, normal, mu, at.sigma);
        ++added;
      }
    }
  }
  return added;
}

std::size_t cut_ears(Front& front, const std::vector<std::uint32_t>& opening) {
  const Sheet& sheet = front.sheet();
  std::vector<std::uint32_t> loop = opening;
  Vector3f normal = Vector3f::Zero();
  for (const std::uint32_t v : loop) {
    normal += sheet.normals[v];
  }
  if (!(normal.norm() > 1e-3F)) {
    return 0;
  }
  normal.normalize();
  std::size_t added = 0;
  while (loop.size() >= 3) {
    const std::size_t n = loop.size();
    float best_shape = 0;
    std::size_t best = n;
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint32_t before = loop[(i + n - 1) % n];
      const std::uint32_t here = loop[i];
      const std::uint32_t after = loop[(i + 1) % n];
      if (!front.is_open(before, here) || !front.is_open(here, after) ||
          !front.accepts({after, here, before})) {
        continue;
      }
      if (n == 3 && !front.is_open(after, before)) {
        continue;
      }
      const Vector3f ab = sheet.positions[here] - sheet.positions[after];
      const Vector3f ac = sheet.positions[before] - sheet.positions[after];
      const Vector3f cross = ab.cross(ac);
      const float longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(),
                                       (sheet.positions[here] - sheet.positions[before]).squaredNorm()});
      const float shape = cross.norm() / std::max(longest2, 1e-20F);
      // Folds are refused; needles are taken only while there is nothing better.
      const bool faces_out = cross.dot(normal) > 0.2F * cross.norm();
      if (faces_out && shape > 1e-3F && shape > best_shape) {
        best_shape = shape;
        best = i;
      }
    }
    if (best == n) {
      break;
    }
    front.add_face({loop[(best + 1) % n], loop[best], loop[(best + n - 1) % n]});
    ++added;
    if (n == 3) {
      break;
    }
    loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return added;
}

GapFillResult fill_gaps(Front& front, const SeamOptions& seam, const GapFillOptions& options,
                        const JobContext& job) {
  GapFillResult result;
  result.first_interpolated = front.sheet().positions.size();
  const auto gaps = [&] {
    auto openings = front.openings();
    OuterRims outer_rims(front.sheet());
    std::erase_if(openings, [&](const auto& o) {
      return !is_gap(front.sheet(), o, options) || !has_room(front.sheet(), o, seam) || outer_rims.contain(o);
    });
    return openings;
  };
  std::vector<std::vector<std::uint32_t>> open = gaps();
  for (const auto& opening : open) {
    if (job.cancelled()) {
      return result;
    }
    if (opening_diameter_mm(front.sheet(), opening) > 2.5 * mean_spacing_mm(front.sheet(), opening)) {
      interpolate_vertices(front, opening);
    }
  }
  for (const double least_angle_rad : {seam.least_angle_rad, 0.4 * seam.least_angle_rad, 0.01}) {
    if (open.empty() || job.cancelled()) {
      break;
    }
    result.faces += close_openings(front, open, least_angle_rad, seam, job);
    open = gaps();
  }
  for (const auto& opening : open) {
    if (opening.size() <= 40 && !job.cancelled()) {
      result.faces += cut_ears(front, opening);
    }
  }
  return result;
}

}  // namespace dubsar
