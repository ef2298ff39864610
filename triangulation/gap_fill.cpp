// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/gap_fill.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "triangulation/loose_vertices.h"
#include "triangulation/opening_plane.h"
#include "triangulation/outer_rims.h"

namespace dubsar {

namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr double kSeenWithinSpacings = 2.5;
/// Openings with more vertices than this are outer boundaries, not gaps.
constexpr std::size_t kMostVertices = 400;

/// Interpolated vertices stay so far from measured ones and from the rim.
constexpr float kApartSpacings = 0.6F;

/// A loose vertex in an opening.
struct Measured {
  std::uint32_t vertex = 0;
  Vector2f place{0, 0};
  float above = 0;     ///< where the rim would put it
  bool taken = false;  ///< to close the opening with: others lie next to one that is
};

/// The surest first.
std::vector<Measured> measured_inside(const Sheet& sheet, const OpeningPlane& plane,
                                      const LooseVertices& loose) {
  constexpr float kMostAboveSpacings = 2.0F;
  constexpr float kLeastCos = 0.4F;
  std::vector<Measured> found;
  if (loose.empty()) {
    return found;
  }
  const float mu = plane.spacing_mm();
  const Vector2f middle = 0.5F * (plane.low() + plane.high());
  const float reach_mm = 0.5F * (plane.high() - plane.low()).norm();
  for (const std::uint32_t v : loose.near(plane.at(middle, 0), reach_mm + kMostAboveSpacings * mu)) {
    const Vector2f place = plane.place_of(sheet.positions[v]);
    if (!plane.encloses(place) || sheet.normals[v].dot(plane.normal()) < kLeastCos) {
      continue;
    }
    const float above = plane.height_of(sheet.positions[v]) - plane.interpolate(place).height;
    if (std::abs(above) < kMostAboveSpacings * mu) {
      found.push_back({v, place, above, false});
    }
  }
  std::ranges::stable_sort(found, std::less<>(), [&](const Measured& m) { return sheet.sigma_mm[m.vertex]; });
  const float apart2 = kApartSpacings * kApartSpacings * mu * mu;
  for (Measured& m : found) {
    m.taken =
        plane.distance2_to_edges(m.place) > apart2 && std::ranges::none_of(found, [&](const Measured& o) {
          return o.taken && (o.place - m.place).squaredNorm() < apart2;
        });
  }
  return found;
}

/// How far what was measured beside it draws an interpolated place off the height that the rim gives it.
float drawn_by(const std::vector<Measured>& measured, const Vector2f& p, float mu) {
  float sum = 0;
  float weights = 1;
  for (const Measured& m : measured) {
    if (m.taken) {
      const float weight = mu * mu / std::max((m.place - p).squaredNorm(), 1e-6F * mu * mu);
      sum += weight * m.above;
      weights += weight;
    }
  }
  return sum / weights;
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
  Vector3f middle = Vector3f::Zero();
  for (const std::uint32_t v : opening) {
    middle += sheet.positions[v] / static_cast<float>(opening.size());
  }
  const auto radius_mm = static_cast<float>(kSeenWithinSpacings * spacing_mm);
  std::size_t most_scans = 0;
  const auto seen = [&](const Vector3f& p) {
    const std::size_t scans = options.samples_near(p, radius_mm).size();
    most_scans = std::max(most_scans, scans);
    return scans > 0;
  };
  // What one scan has there may be what lies around the opening.
  return options.samples_near && seen(middle) &&
         std::ranges::all_of(opening,
                             [&](std::uint32_t v) { return seen(0.5F * (middle + sheet.positions[v])); }) &&
         most_scans > 1;
}

}  // namespace

namespace {

/// Whether it is as narrow as a gap may be.
bool is_narrow(const Sheet& sheet, const std::vector<std::uint32_t>& opening, const GapFillOptions& options) {
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

/// Whether its rim is red: vertices that are sparse by their own scan, and that no other one clears.
bool is_flagged(const Sheet& sheet, const std::vector<std::uint32_t>& opening) {
  constexpr std::ptrdiff_t kLeastSparse = 3;  // around 3 × 3 missing samples there are four
  return std::ranges::count_if(opening, [&](std::uint32_t v) {
           return v < sheet.marks.size() && (sheet.marks[v] & kSparseMark) != 0;
         }) >= kLeastSparse;
}

/// Whether there is a disc that no vertex around the opening lies in, and beside which no scan has a sample
/// within the opening: the red map calls such a place a hole.
bool has_bare_disc(const Sheet& sheet, const std::vector<std::uint32_t>& opening, const LooseVertices& loose,
                   const GapFillOptions& options) {
  constexpr float kStepSpacings = 0.25F;
  constexpr float kMostSteps = 400.0F;
  // What is no deeper in the opening may be of what its rim has been averaged from.
  constexpr float kInsideSpacings = 0.5F;
  const float mu = mean_spacing_mm(sheet, opening);
  const float radius_mm = 0.5F * static_cast<float>(options.bare_disc_factor) * mu;
  const double across_mm = opening_diameter_mm(sheet, opening);
  if (across_mm < 2.0 * static_cast<double>(radius_mm) ||
      across_mm > options.most_width_factor * static_cast<double>(mu)) {  // seen all over, if narrow
    return false;
  }
  const std::optional<OpeningPlane> plane = OpeningPlane::of(sheet, opening);
  if (!plane) {
    return false;
  }
  const auto seen_beside = [&](const Vector2f& p) {
    const Vector3f at = plane->at(p, plane->interpolate(p).height);
    const auto within_mm = static_cast<float>(kSeenWithinSpacings) * mu;
    return !loose.near(at, within_mm).empty() ||
           (options.samples_near &&
            std::ranges::any_of(options.samples_near(at, within_mm), [&](const Vector3f& sample) {
              const Vector2f place = plane->place_of(sample);
              return plane->encloses(place) &&
                     plane->distance2_to_edges(place) > kInsideSpacings * kInsideSpacings * mu * mu;
            }));
  };
  const Vector2f sizes = plane->high() - plane->low();
  const float step_mm = std::max(kStepSpacings * mu, sizes.maxCoeff() / kMostSteps);
  const Vector2f middle = 0.5F * (plane->low() + plane->high());
  const int rows = static_cast<int>(0.5F * sizes.y() / step_mm);
  const int cols = static_cast<int>(0.5F * sizes.x() / step_mm);
  for (int r = -rows; r <= rows; ++r) {
    for (int c = -cols; c <= cols; ++c) {
      const Vector2f p = middle + step_mm * Vector2f(static_cast<float>(c), static_cast<float>(r));
      if (plane->distance2_to_vertices(p) < radius_mm * radius_mm || !plane->encloses(p)) {
        continue;
      }
      if (!seen_beside(p)) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

bool is_gap(const Sheet& sheet, const std::vector<std::uint32_t>& opening, const LooseVertices& loose,
            const GapFillOptions& options) {
  return is_narrow(sheet, opening, options) &&
         !(is_flagged(sheet, opening) && has_bare_disc(sheet, opening, loose, options));
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

std::size_t place_vertices(Front& front, const std::vector<std::uint32_t>& opening,
                           const LooseVertices& loose) {
  const Sheet& sheet = front.sheet();
  const std::optional<OpeningPlane> plane = OpeningPlane::of(sheet, opening);
  if (!plane) {
    return 0;
  }
  const float mu = plane->spacing_mm();
  const float apart2 = kApartSpacings * kApartSpacings * mu * mu;
  const std::vector<Measured> measured = measured_inside(sheet, *plane, loose);
  for (const Measured& m : measured) {
    if (m.taken) {
      front.offer_vertex(m.vertex);
    }
  }
  const float row_mm = mu * 0.866F;
  const Vector2f sizes = plane->high() - plane->low();
  const int rows = static_cast<int>(sizes.y() / row_mm) + 1;
  const int cols = static_cast<int>(sizes.x() / mu) + 1;
  std::size_t added = 0;
  for (int r = 0; r <= rows && rows < 200; ++r) {
    for (int c = 0; c <= cols && cols < 200; ++c) {
      const Vector2f p = plane->low() + Vector2f(mu * (static_cast<float>(c) + ((r & 1) != 0 ? 0.5F : 0.0F)),
                                                 row_mm * static_cast<float>(r));
      const bool clear =
          plane->distance2_to_edges(p) > apart2 && std::ranges::all_of(measured, [&](const Measured& m) {
            return (m.place - p).squaredNorm() > apart2;
          });
      if (clear && plane->encloses(p)) {
        const OpeningPlane::Interpolated at = plane->interpolate(p);
        front.add_vertex(plane->at(p, at.height + drawn_by(measured, p, mu)), plane->normal(), mu, at.sigma);
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
  const LooseVertices loose(front.sheet());
  const auto gaps = [&] {
    auto openings = front.openings();
    OuterRims outer_rims(front.sheet());
    std::erase_if(openings, [&](const auto& o) {
      return !is_gap(front.sheet(), o, loose, options) || !has_room(front.sheet(), o, seam) ||
             outer_rims.contain(o);
    });
    return openings;
  };
  std::vector<std::vector<std::uint32_t>> open = gaps();
  for (const auto& opening : open) {
    if (job.cancelled()) {
      return result;
    }
    if (opening_diameter_mm(front.sheet(), opening) > 2.5 * mean_spacing_mm(front.sheet(), opening)) {
      place_vertices(front, opening, loose);
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
