// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/inner_edges.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/random.h"

namespace dubsar {

namespace {

constexpr int kDraws = 60;
/// Of every wedge the same: its contacts differ, and no number of the mesh's is to decide.
constexpr std::uint64_t kSeed = 0;
constexpr std::size_t kLeastContacts = 4;
/// A curve is taken only when it explains so much more than the line.
constexpr double kCurveGain = 1.1;
/// A bow is told from a line by less than what tells contacts from strays.
constexpr double kCurveTolerance = 0.6;
/// Scatter below this is not believed: the mesh samples no finer.
constexpr double kFloorMm = 0.004;
constexpr double kFloorRad = 0.005;

struct Contact {
  Eigen::Vector3d p;
  double weight;
};

struct Line {
  Eigen::Vector3d point{0, 0, 0};
  Eigen::Vector3d direction{0, 0, 1};
  double rms_mm = 0;
  double sigma_rad = 0;
  std::vector<Contact> inliers;
};

/// Nearest to the middle of a and b on the tangent planes of both faces: where the crease between passes.
Eigen::Vector3d crease_between(const Eigen::Vector3d& a, const Eigen::Vector3d& normal_a,
                               const Eigen::Vector3d& b, const Eigen::Vector3d& normal_b) {
  const Eigen::Vector3d middle = 0.5 * (a + b);
  const double c = normal_a.dot(normal_b);
  const double off_a = normal_a.dot(a - middle);
  const double off_b = normal_b.dot(b - middle);
  const double scale = 1.0 / std::max(1.0 - c * c, 1e-3);
  const Eigen::Vector3d shift = scale * ((off_a - c * off_b) * normal_a + (off_b - c * off_a) * normal_b);
  // The crease cannot lie beyond the edge that crosses it.
  const double most = (a - b).norm();
  return middle + (shift.norm() > most ? Eigen::Vector3d(shift * (most / shift.norm())) : shift);
}

/// In the order in which they lie along the edges: what is drawn of them must not hang on how the vertices of
/// the mesh are numbered.
std::array<std::vector<Contact>, 3> find_contacts(const WedgePatch& patch, const WedgeFaces& faces) {
  std::array<std::vector<Contact>, 3> contacts;
  const double core_mm = std::max(2.0 * patch.spacing_mm, 0.2 * patch.depth_mm);
  for (std::uint32_t v = 0; v < patch.size(); ++v) {
    const int a{faces.face[v]};
    if (a < 0) {
      continue;
    }
    for (std::uint32_t k = patch.graph.start[v]; k < patch.graph.start[v + 1]; ++k) {
      const std::uint32_t n = patch.graph.neighbour[k];
      const int b{faces.face[n]};
      if (b < 0 || b != (a + 1) % 3) {
        continue;
      }
      const auto edge = static_cast<std::size_t>(b);  // between faces b - 1 and b
      const Eigen::Vector3d p =
          crease_between(patch.p[v].cast<double>(), faces.plane[static_cast<std::size_t>(a)].normal,
                         patch.p[n].cast<double>(), faces.plane[static_cast<std::size_t>(b)].normal);
      const double away = (p - faces.depth_point).norm();
      const double near_centre = away / (away + core_mm);
      const double reliability = fit_weight(std::min(patch.weight[v], patch.weight[n]));
      contacts[edge].push_back({p, reliability * near_centre});
    }
  }
  for (std::size_t edge = 0; edge < 3; ++edge) {
    std::ranges::stable_sort(contacts[edge], {}, [&](const Contact& c) { return c.p.dot(faces.edge[edge]); });
  }
  return contacts;
}

double off_line(const Contact& contact, const Eigen::Vector3d& point, const Eigen::Vector3d& direction) {
  return (contact.p - point).cross(direction).norm();
}

/// Weighted line of contacts; through `fixed` when given.
void fit_line(const std::vector<Contact>& contacts, const Eigen::Vector3d* fixed, Line* line) {
  double total = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Contact& c : contacts) {
    total += c.weight;
    mean += c.weight * c.p;
  }
  line->point = fixed != nullptr ? *fixed : Eigen::Vector3d(mean / total);
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (const Contact& c : contacts) {
    const Eigen::Vector3d d = c.p - line->point;
    moment += c.weight * d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moment / total);
  const Eigen::Vector3d along = solver.eigenvectors().col(2);
  line->direction = along.dot(line->direction) < 0 ? Eigen::Vector3d(-along) : along;
  double squares = 0;
  for (const Contact& c : contacts) {
    const double off = off_line(c, line->point, line->direction);
    squares += c.weight * off * off;
  }
  line->rms_mm = std::sqrt(squares / total);
  // Neighbouring contacts share vertices: about every third is independent.
  const double independent = std::max(1.0, static_cast<double>(contacts.size()) / 3.0);
  const double spread = std::sqrt(std::max(solver.eigenvalues()(2), 1e-10));
  line->sigma_rad = std::max(line->rms_mm, kFloorMm) / (spread * std::sqrt(independent)) + kFloorRad;
}

std::optional<Line> ransac_line(const std::vector<Contact>& contacts, const Eigen::Vector3d& guess,
                                double tolerance_mm, Random random) {
  if (contacts.size() < kLeastContacts) {
    return std::nullopt;
  }
  const double least_apart = 3.0 * tolerance_mm;
  std::optional<Line> best;
  double best_score = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Contact& a = contacts[random.below(contacts.size())];
    const Contact& b = contacts[random.below(contacts.size())];
    Eigen::Vector3d direction = b.p - a.p;
    const double length = direction.norm();
    if (length < least_apart) {
      continue;
    }
    direction *= (direction.dot(guess) < 0 ? -1.0 : 1.0) / length;
    if (direction.dot(guess) < 0.8) {
      continue;
    }
    double score = 0;
    for (const Contact& c : contacts) {
      const double u = off_line(c, a.p, direction) / tolerance_mm;
      score += u < 1 ? c.weight * (1 - u * u) : 0.0;
    }
    if (score > best_score) {
      best_score = score;
      best = Line{.point = a.p, .direction = direction, .inliers = {}};
    }
  }
  if (!best) {
    return std::nullopt;
  }
  for (int round = 0; round < 2; ++round) {
    best->inliers.clear();
    for (const Contact& c : contacts) {
      if (off_line(c, best->point, best->direction) < tolerance_mm) {
        best->inliers.push_back(c);
      }
    }
    if (best->inliers.size() < kLeastContacts) {
      return std::nullopt;
    }
    fit_line(best->inliers, nullptr, &*best);
  }
  return best;
}

/// The point that lines and planes are nearest to, each by its own uncertainty.
Eigen::Vector3d shared_point(const WedgeFaces& faces, const std::array<std::optional<Line>, 3>& lines,
                             double* sigma_mm) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const FacePlane& plane : faces.plane) {
    const double away = std::abs((faces.depth_point - plane.middle).norm());
    const double independent = std::max(1.0, plane.count / 4.0);
    const double sigma =
        std::hypot(std::max(plane.rms_mm, kFloorMm) / std::sqrt(independent), plane.sigma_rad * away) +
        0.5 * kFloorMm;
    const double w = 1.0 / (sigma * sigma);
    normal += w * plane.normal * plane.normal.transpose();
    right += w * plane.offset_mm * plane.normal;
  }
  for (const auto& line : lines) {
    if (line) {
      const double away = (faces.depth_point - line->point).norm();
      const double independent = std::max(1.0, static_cast<double>(line->inliers.size()) / 3.0);
      const double sigma =
          std::hypot(std::max(line->rms_mm, kFloorMm) / std::sqrt(independent), line->sigma_rad * away) +
          kFloorMm;
      const Eigen::Matrix3d across =
          (Eigen::Matrix3d::Identity() - line->direction * line->direction.transpose()) / (sigma * sigma);
      normal += across;
      right += across * line->point;
    }
  }
  const Eigen::Matrix3d covariance = normal.inverse();
  *sigma_mm = std::sqrt(covariance.trace());
  return covariance * right;
}

/// A curve through the shared point: off the line by a t + b t², t along it.
struct Curve {
  Eigen::Vector3d a{0, 0, 0}, b{0, 0, 0};
  [[nodiscard]] Eigen::Vector3d off(double t) const { return t * a + t * t * b; }
};

/// How well a curve explains the contacts; as ransac_line() scores lines.
double score_of(const std::vector<Contact>& contacts, const Line& line, const Curve& curve,
                double tolerance_mm) {
  double score = 0;
  for (const Contact& c : contacts) {
    const Eigen::Vector3d to = c.p - line.point;
    const double t = to.dot(line.direction);
    const double u = (to - t * line.direction - curve.off(t)).norm() / tolerance_mm;
    score += u < 1 ? c.weight * (1 - u * u) : 0.0;
  }
  return score;
}

/// Middle of the curve that explains the contacts clearly better than the line does, off its chord; 0 where
/// none does. `line` goes through the shared point.
double bow_of(const std::vector<Contact>& contacts, const Line& line, double tolerance_mm, double* extent_mm,
              Random random) {
  if (contacts.size() < 3 * kLeastContacts) {
    return 0;
  }
  const double straight = score_of(contacts, line, {}, tolerance_mm);
  Curve best;
  double best_score = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Eigen::Vector3d p = contacts[random.below(contacts.size())].p - line.point;
    const Eigen::Vector3d q = contacts[random.below(contacts.size())].p - line.point;
    const double s = p.dot(line.direction);
    const double t = q.dot(line.direction);
    if (s < 3 * tolerance_mm || std::abs(t - s) < 3 * tolerance_mm || t < 3 * tolerance_mm) {
      continue;
    }
    const Eigen::Vector3d off_s = (p - s * line.direction) / s;
    const Eigen::Vector3d off_t = (q - t * line.direction) / t;
    const Eigen::Vector3d bend = (off_t - off_s) / (t - s);
    const Curve curve{off_s - s * bend, bend};
    if (const double score = score_of(contacts, line, curve, tolerance_mm); score > best_score) {
      best_score = score;
      best = curve;
    }
  }
  if (best_score < kCurveGain * straight) {
    return 0;
  }
  double extent = 0;
  for (const Contact& c : contacts) {
    const Eigen::Vector3d to = c.p - line.point;
    const double t = to.dot(line.direction);
    if ((to - t * line.direction - best.off(t)).norm() < tolerance_mm) {
      extent = std::max(extent, t);
    }
  }
  *extent_mm = std::max(*extent_mm, extent);
  return 0.25 * extent * extent * best.b.norm();
}

}  // namespace

InnerEdges find_inner_edges(const WedgePatch& patch, const WedgeFaces& faces) {
  const std::array<std::vector<Contact>, 3> contacts = find_contacts(patch, faces);
  std::array<std::optional<Line>, 3> lines;
  const double tolerance_mm = std::max({0.03, 0.5 * patch.spacing_mm, 0.06 * patch.depth_mm});
  for (std::size_t k = 0; k < 3; ++k) {
    lines[k] = ransac_line(contacts[k], faces.edge[k], tolerance_mm, Random(seed_for(kSeed, k)));
  }
  InnerEdges out;
  out.depth_point = shared_point(faces, lines, &out.depth_point_sigma_mm);
  for (std::size_t k = 0; k < 3; ++k) {
    InnerEdge& edge = out.edge[k];
    const FacePlane& before = faces.plane[(k + 2) % 3];
    const FacePlane& after = faces.plane[k];
    const double sine = before.normal.cross(after.normal).norm();
    const double sigma_planes = std::hypot(before.sigma_rad, after.sigma_rad) / sine + kFloorRad;
    edge.direction = faces.edge[k];
    edge.sigma_rad = sigma_planes;
    if (lines[k]) {
      Line& line = *lines[k];
      fit_line(line.inliers, &out.depth_point, &line);
      for (const Contact& c : line.inliers) {
        edge.extent_mm = std::max(edge.extent_mm, (c.p - out.depth_point).dot(line.direction));
      }
      edge.rms_mm = line.rms_mm;
      edge.off_planes_rad =
          std::atan2(line.direction.cross(faces.edge[k]).norm(), line.direction.dot(faces.edge[k]));
      edge.bow_mm = bow_of(contacts[k], line, kCurveTolerance * tolerance_mm, &edge.extent_mm,
                           Random(seed_for(kSeed, 3 + k)));
      const double w_line = 1.0 / (line.sigma_rad * line.sigma_rad);
      const double w_planes = 1.0 / (sigma_planes * sigma_planes);
      edge.direction = (w_line * line.direction + w_planes * faces.edge[k]).normalized();
      edge.sigma_rad = 1.0 / std::sqrt(w_line + w_planes);
    }
  }
  return out;
}

}  // namespace dubsar
