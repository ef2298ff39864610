// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/wedge_faces.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "analysis/face_labels.h"
#include "analysis/normal_clusters.h"
#include "core/units.h"

namespace dubsar {

namespace {

constexpr int kRounds = 9;
/// The first surroundings reach this many depths from the lowest vertex, at least so many spacings.
constexpr double kFirstReachDepths = 1.7;
constexpr double kFirstReachSpacings = 5.0;
constexpr double kReachGrowth = 1.5;
/// Normals nearer than this to the free surface's are of the rim.
constexpr float kUpright = 0.985F;

struct Search {
  const WedgePatch& patch;
  const FaceOptions& options;
  WedgeFaces faces;
  double tolerance_mm = 0;
  double reach_mm = 0;
};

/// Weighted least-squares plane of a face's vertices, two rounds with Tukey's weight.
bool fit_plane(const Search& s, std::size_t k, FacePlane* plane) {
  for (int round = 0; round < 2; ++round) {
    double total = 0;
    double squares = 0;
    std::uint32_t count = 0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < s.patch.size(); ++i) {
      if (s.faces.face[i] != static_cast<std::int8_t>(k)) {
        continue;
      }
      const Eigen::Vector3d p = s.patch.p[i].cast<double>();
      const double off = plane->distance(p);
      const double u = off / (1.5 * s.tolerance_mm);
      const double tukey = std::abs(u) < 1 ? (1 - u * u) * (1 - u * u) : 0.0;
      const double w = (0.02 + static_cast<double>(s.patch.weight[i])) * tukey;
      total += w;
      squares += w * off * off;
      mean += w * p;
      moment += w * p * p.transpose();
      ++count;
    }
    if (count < 3 || !(total > 0)) {
      return false;
    }
    mean /= total;
    const Eigen::Matrix3d covariance = moment / total - mean * mean.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    Eigen::Vector3d normal = solver.eigenvectors().col(0);
    if (normal.dot(plane->normal) < 0) {
      normal = -normal;
    }
    // A cluster that is a mere line gives no plane: keep the normal that its vertices have.
    if (solver.eigenvalues()(1) < 1e-8 || normal.dot(plane->normal) < 0.5) {
      normal = plane->normal;
    }
    plane->normal = normal;
    plane->offset_mm = normal.dot(mean);
    plane->rms_mm = std::sqrt(squares / total);
    plane->weight = total;
    plane->count = count;
    const double spread = std::sqrt(std::max(solver.eigenvalues()(1), 1e-12));
    plane->sigma_rad = plane->rms_mm / (spread * std::sqrt(static_cast<double>(count)));
  }
  return true;
}

/// Gives each vertex in reach the face whose plane is highest there, where its place and normal agree.
void assign(Search* s) {
  const auto gate = static_cast<float>(std::cos(rad_from_deg(s->options.normal_gate_deg)));
  std::array<Eigen::Vector3f, 3> normals;
  for (std::size_t k = 0; k < 3; ++k) {
    normals[k] = s->faces.plane[k].normal.cast<float>();
  }
  for (std::size_t i = 0; i < s->patch.size(); ++i) {
    s->faces.face[i] = -1;
    const Eigen::Vector3d p = s->patch.p[i].cast<double>();
    if (p.head<2>().squaredNorm() > s->reach_mm * s->reach_mm) {
      continue;
    }
    std::size_t top = 0;
    double height = -1e30;
    for (std::size_t k = 0; k < 3; ++k) {
      const double h = s->faces.plane[k].height_at(p);
      if (h > height) {
        height = h;
        top = k;
      }
    }
    if (std::abs(s->faces.plane[top].distance(p)) < s->tolerance_mm && s->patch.n[i].dot(normals[top]) > gate) {
      s->faces.face[i] = static_cast<std::int8_t>(top);
    }
  }
}

/// First planes: through the middle of each cluster of normals near the lowest vertex.
bool start(Search* s) {
  std::vector<Eigen::Vector3f> normals;
  std::vector<float> weights;
  std::vector<std::size_t> index;
  const auto near = static_cast<float>(2.0 * s->patch.spacing_mm);
  for (std::size_t i = 0; i < s->patch.size(); ++i) {
    const float away = s->patch.p[i].head<2>().norm();
    if (away < static_cast<float>(s->reach_mm) && s->patch.n[i].z() < kUpright && s->patch.n[i].z() > -0.2F) {
      normals.push_back(s->patch.n[i]);
      // Dirt gathers at the deepest place, and the mesh rounds it off.
      weights.push_back((0.02F + s->patch.weight[i]) * (away < near ? 0.3F : 1.0F));
      index.push_back(i);
    }
  }
  if (normals.size() < 3 * s->options.min_face_vertices) {
    return false;
  }
  const auto centres = cluster_normals(normals, weights);
  if (!centres) {
    return false;
  }
  std::ranges::fill(s->faces.face, std::int8_t{-1});
  std::array<Eigen::Vector3d, 3> sum = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                        Eigen::Vector3d::Zero()};
  std::array<double, 3> total{};
  for (std::size_t j = 0; j < index.size(); ++j) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      best = normals[j].dot((*centres)[k].cast<float>()) > normals[j].dot((*centres)[best].cast<float>()) ? k : best;
    }
    sum[best] += weights[j] * s->patch.p[index[j]].cast<double>();
    total[best] += weights[j];
    s->faces.face[index[j]] = static_cast<std::int8_t>(best);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(total[k] > 0)) {
      return false;
    }
    s->faces.plane[k].normal = (*centres)[k];
    s->faces.plane[k].offset_mm = (*centres)[k].dot(sum[k] / total[k]);
  }
  return true;
}

/// Median absolute distance of the faces' vertices, as a standard deviation.
double spread_of(const Search& s) {
  std::vector<double> off;
  for (std::size_t i = 0; i < s.patch.size(); ++i) {
    if (s.faces.face[i] >= 0) {
      off.push_back(std::abs(
          s.faces.plane[static_cast<std::size_t>(s.faces.face[i])].distance(s.patch.p[i].cast<double>())));
    }
  }
  if (off.empty()) {
    return 0;
  }
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::ranges::nth_element(off, middle);
  return 1.4826 * *middle;
}

/// Depth point and inner edges of the planes; what is wrong when they do not bound a pit.
std::optional<std::string> meet(const FaceOptions& options, WedgeFaces* faces) {
  Eigen::Matrix3d normals;
  Eigen::Vector3d offsets;
  for (std::size_t k = 0; k < 3; ++k) {
    normals.row(static_cast<Eigen::Index>(k)) = faces->plane[k].normal.transpose();
    offsets(static_cast<Eigen::Index>(k)) = faces->plane[k].offset_mm;
  }
  if (!(normals.determinant() > 0.02)) {
    return "its faces do not close to a pit";
  }
  faces->depth_point = normals.partialPivLu().solve(offsets);
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d& before = faces->plane[(k + 2) % 3].normal;
    const Eigen::Vector3d& after = faces->plane[k].normal;
    const Eigen::Vector3d along = before.cross(after);
    const double opening = kPi - std::atan2(along.norm(), before.dot(after));
    if (opening < rad_from_deg(options.min_opening_deg) || opening > rad_from_deg(options.max_opening_deg)) {
      return "an opening angle is out of bounds";
    }
    faces->edge[k] = along.normalized();
    if (faces->edge[k].z() < 0.01) {
      return "an inner edge does not rise";
    }
  }
  return std::nullopt;
}

}  // namespace

std::expected<WedgeFaces, std::string> find_faces(const WedgePatch& patch, const FaceOptions& options) {
  Search s{patch, options, {}, 0, 0};
  s.faces.face.assign(patch.size(), -1);
  s.reach_mm = std::max(kFirstReachDepths * patch.depth_mm, kFirstReachSpacings * patch.spacing_mm);
  if (!start(&s)) {
    return std::unexpected("its normals do not gather in three faces");
  }
  double widest = 0;
  for (const Eigen::Vector3f& p : patch.p) {
    widest = std::max(widest, static_cast<double>(p.head<2>().norm()));
  }
  const double loosest = std::max(0.15 * patch.depth_mm, 0.03);
  const double tightest = std::max(0.02, 0.04 * patch.depth_mm);
  s.tolerance_mm = 1.5 * loosest;
  for (int round = 0; round < kRounds; ++round) {
    if (round > 0) {
      assign(&s);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if (!fit_plane(s, k, &s.faces.plane[k])) {
        return std::unexpected("one of its faces has no vertices");
      }
    }
    s.tolerance_mm = std::clamp(3.0 * spread_of(s), tightest, loosest);
    if (round > 1) {
      s.reach_mm = std::min(s.reach_mm * kReachGrowth, widest + patch.spacing_mm);
    }
  }
  assign(&s);
  clean_labels(patch, &s.faces.face);
  for (std::size_t k = 0; k < 3; ++k) {
    if (!fit_plane(s, k, &s.faces.plane[k])) {
      return std::unexpected("one of its faces has no vertices");
    }
  }
  std::uint32_t all = 0;
  for (const FacePlane& plane : s.faces.plane) {
    all += plane.count;
  }
  for (const FacePlane& plane : s.faces.plane) {
    if (plane.count < options.min_face_vertices || plane.count < options.min_face_share * all) {
      return std::unexpected("one of its faces is too small");
    }
  }
  if (const auto wrong = meet(options, &s.faces)) {
    return std::unexpected(*wrong);
  }
  return std::move(s.faces);
}

}  // namespace dubsar
