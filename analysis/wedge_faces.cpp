// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/wedge_faces.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "analysis/face_labels.h"
#include "analysis/normal_clusters.h"
#include "analysis/plane_refit.h"
#include "core/order_statistics.h"
#include "core/units.h"

namespace dubsar {

namespace {

constexpr std::size_t kMostClustered = 600;
constexpr int kFirstRounds = 3;
constexpr int kRounds = 6;
/// The first surroundings reach this many depths from the lowest vertex, at least so many spacings; where
/// they hold no pit the next. A wedge that dirt has filled is wider than it is deep, its lowest place
/// anywhere.
constexpr std::array<double, 3> kReachDepths = {1.7, 4.0, 10.0};
constexpr double kFirstReachSpacings = 5.0;
constexpr double kReachGrowth = 1.5;
/// Triangles nearer than this to the free surface are of the rim, which is heaped up or worn round; in depths
/// of the wedge.
constexpr float kRimDepths = 0.1F;
/// Normals nearer than this to the free surface's are of the rim.
constexpr float kUpright = 0.985F;
/// Refitted planes that move the depth point by more spacings fit something else.
constexpr double kMostMoved = 2.0;

struct Search {
  const WedgePatch& patch;
  const FaceOptions& options;
  WedgeFaces faces;
  std::vector<std::int8_t> triangle_face;  ///< of each triangle of the patch, or -1
  std::vector<float> agreement;            ///< of its normal with its face's, 0 to 1
  float highest = 0;                       ///< triangles above this are of the rim, mm
  double tolerance_mm = 0;
  double reach_mm = 0;
};

/// How far a vertex may lie off its face before the scatter is known.
double loosest_mm(const WedgePatch& patch) {
  return std::max(0.15 * patch.depth_mm, 0.03);
}

/// Weighted least-squares plane of a face's triangles, two rounds with Tukey's weight.
bool fit_plane(const Search& s, std::size_t k, FacePlane* plane) {
  for (int round = 0; round < 2; ++round) {
    double total = 0;
    double squares = 0;
    std::uint32_t count = 0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < s.patch.triangles.size(); ++i) {
      if (s.triangle_face[i] != static_cast<std::int8_t>(k)) {
        continue;
      }
      const PatchTriangle& t = s.patch.triangles[i];
      ++count;
      for (const std::uint32_t v : t.vertex) {
        const Eigen::Vector3d p = s.patch.p[v].cast<double>();
        const double off = plane->distance(p);
        const double u = off / (1.5 * s.tolerance_mm);
        const double tukey = std::abs(u) < 1 ? (1 - u * u) * (1 - u * u) : 0.0;
        const double w = s.agreement[i] * t.weight * tukey / 3.0;
        total += w;
        squares += w * off * off;
        mean += w * p;
        moment += w * p * p.transpose();
      }
    }
    if (count < 2 || !(total > 0)) {
      return false;
    }
    mean /= total;
    const Eigen::Matrix3d covariance = moment / total - mean * mean.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
    Eigen::Vector3d normal = solver.eigenvectors().col(0);
    if (normal.dot(plane->normal) < 0) {
      normal = -normal;
    }
    // A cluster that is a mere line gives no plane: keep the normal that its triangles have.
    if (solver.eigenvalues()(1) < 1e-8 || normal.dot(plane->normal) < 0.5) {
      normal = plane->normal;
    }
    plane->normal = normal;
    plane->offset_mm = normal.dot(mean);
    plane->middle = mean;
    plane->rms_mm = std::sqrt(squares / total);
    plane->weight = total;
    plane->count = count;
    // About two triangles share a vertex of their own.
    const double spread = std::sqrt(std::max(solver.eigenvalues()(1), 1e-12));
    plane->sigma_rad = plane->rms_mm / (spread * std::sqrt(0.5 * count));
  }
  return true;
}

/// Gives each triangle in reach the face whose plane is highest there, where its corners and its normal
/// agree.
void assign(Search* s) {
  const auto gate = static_cast<float>(std::cos(rad_from_deg(s->options.normal_gate_deg)));
  std::array<Eigen::Vector3f, 3> normals;
  for (std::size_t k = 0; k < 3; ++k) {
    normals[k] = s->faces.plane[k].normal.cast<float>();
  }
  for (std::size_t i = 0; i < s->patch.triangles.size(); ++i) {
    const PatchTriangle& t = s->patch.triangles[i];
    s->triangle_face[i] = -1;
    const Eigen::Vector3d middle = t.middle.cast<double>();
    if (middle.head<2>().squaredNorm() > s->reach_mm * s->reach_mm) {
      continue;
    }
    std::size_t top = 0;
    double height = -1e30;
    for (std::size_t k = 0; k < 3; ++k) {
      const double h = s->faces.plane[k].height_at(middle);
      if (h > height) {
        height = h;
        top = k;
      }
    }
    const FacePlane& plane = s->faces.plane[top];
    const float cosine = t.n.dot(normals[top]);
    bool near = cosine > gate && t.height < s->highest;
    // Those on the bend to the next face count less than those that look the way their face does.
    s->agreement[i] = (cosine - gate) / (1.0F - gate);
    for (std::size_t c = 0; c < 3 && near; ++c) {
      near = std::abs(plane.distance(s->patch.p[t.vertex[c]].cast<double>())) < s->tolerance_mm;
    }
    s->triangle_face[i] = near ? static_cast<std::int8_t>(top) : std::int8_t{-1};
  }
}

/// A vertex is of the face that most of the triangles around it are of, by area.
void label_vertices(Search* s) {
  std::vector<std::array<float, 4>> votes(s->patch.size(), {0, 0, 0, 0});
  for (std::size_t i = 0; i < s->patch.triangles.size(); ++i) {
    const PatchTriangle& t = s->patch.triangles[i];
    for (const std::uint32_t v : t.vertex) {
      votes[v][s->triangle_face[i] < 0 ? 3 : static_cast<std::size_t>(s->triangle_face[i])] += t.weight;
    }
  }
  for (std::size_t v = 0; v < s->patch.size(); ++v) {
    std::size_t most = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      most = votes[v][k] > votes[v][most] ? k : most;
    }
    const bool mostly = votes[v][most] > 0 && 2 * (votes[v][0] + votes[v][1] + votes[v][2]) >= votes[v][3];
    s->faces.face[v] = mostly ? static_cast<std::int8_t>(most) : std::int8_t{-1};
  }
}

/// Triangles whose corners lost their label in the cleaning lose theirs.
void drop_cleaned(Search* s) {
  for (std::size_t i = 0; i < s->patch.triangles.size(); ++i) {
    const PatchTriangle& t = s->patch.triangles[i];
    if (s->faces.face[t.vertex[0]] < 0 && s->faces.face[t.vertex[1]] < 0 && s->faces.face[t.vertex[2]] < 0) {
      s->triangle_face[i] = -1;
    }
  }
}

struct Near {
  std::vector<Eigen::Vector3f> normals, middles;
  std::vector<float> weights;
};

/// The triangles near the lowest vertex that can be of a wedge's face.
Near triangles_near(const Search& s) {
  Near near;
  const auto centre = static_cast<float>(s.patch.spacing_mm);
  for (const PatchTriangle& t : s.patch.triangles) {
    const float away = t.middle.head<2>().norm();
    if (away < static_cast<float>(s.reach_mm) && t.height < s.highest && t.n.z() < kUpright &&
        t.n.z() > -0.2F) {
      near.normals.push_back(t.n);
      near.middles.push_back(t.middle);
      // Dirt gathers at the deepest place.
      near.weights.push_back(t.weight * (away < centre ? 0.3F : 1.0F));
    }
  }
  return near;
}

/// First planes: through the middle of each cluster of normals.
bool start(const Near& near, const NormalTriple& centres, Search* s) {
  std::array<Eigen::Vector3d, 3> sum = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                        Eigen::Vector3d::Zero()};
  std::array<double, 3> total{};
  for (std::size_t j = 0; j < near.normals.size(); ++j) {
    const Eigen::Vector3d n = near.normals[j].cast<double>();
    std::size_t best = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      best = n.dot(centres[k]) > n.dot(centres[best]) ? k : best;
    }
    if (n.dot(centres[best]) > 0.9) {
      sum[best] += near.weights[j] * near.middles[j].cast<double>();
      total[best] += near.weights[j];
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(total[k] > 0)) {
      return false;
    }
    s->faces.plane[k].normal = centres[k];
    s->faces.plane[k].offset_mm = centres[k].dot(sum[k] / total[k]);
  }
  return true;
}

/// Median absolute distance of the faces' corners, as a standard deviation.
double spread_of(const Search& s) {
  std::vector<double> off;
  for (std::size_t i = 0; i < s.patch.triangles.size(); ++i) {
    if (s.triangle_face[i] >= 0) {
      const FacePlane& plane = s.faces.plane[static_cast<std::size_t>(s.triangle_face[i])];
      for (const std::uint32_t v : s.patch.triangles[i].vertex) {
        off.push_back(std::abs(plane.distance(s.patch.p[v].cast<double>())));
      }
    }
  }
  return off.empty() ? 0.0 : kSigmaOfMedian * median_of(std::move(off));
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

/// Clusters of the normals, of every n-th of them where there are very many.
std::vector<NormalTriple> cluster_some(const Near& near) {
  const std::size_t step = 1 + near.normals.size() / kMostClustered;
  if (step == 1) {
    return cluster_normals(near.normals, near.weights);
  }
  Near some;
  for (std::size_t i = 0; i < near.normals.size(); i += step) {
    some.normals.push_back(near.normals[i]);
    some.weights.push_back(near.weights[i]);
  }
  return cluster_normals(some.normals, some.weights);
}

/// One round: vertices to planes, planes to vertices.
bool improve(Search* s) {
  assign(s);
  for (std::size_t k = 0; k < 3; ++k) {
    if (!fit_plane(*s, k, &s->faces.plane[k])) {
      return false;
    }
  }
  const double tightest = std::max(0.02, 0.04 * s->patch.depth_mm);
  s->tolerance_mm = std::clamp(3.0 * spread_of(*s), tightest, loosest_mm(s->patch));
  return true;
}

/// The start whose planes, after a few rounds, bound a pit and explain most.
std::optional<std::string> best_start(Search* s) {
  const Near near = triangles_near(*s);
  if (near.normals.size() < 3 * s->options.min_face_triangles) {
    return "too few faces of the mesh";
  }
  std::optional<std::string> wrong = "its normals do not gather in three faces";
  std::optional<Search> best;
  double most = 0;
  for (const NormalTriple& centres : cluster_some(near)) {
    Search trial = *s;
    bool alive = start(near, centres, &trial);
    for (int round = 0; round < kFirstRounds && alive; ++round) {
      alive = improve(&trial);
    }
    if (!alive) {
      continue;
    }
    if (const auto why = meet(s->options, &trial.faces)) {
      wrong = best ? wrong : why;
      continue;
    }
    double explained = 0;
    for (const FacePlane& plane : trial.faces.plane) {
      explained += plane.weight;
    }
    if (explained > most) {
      most = explained;
      best.emplace(trial);
    }
  }
  if (!best) {
    return wrong;
  }
  s->faces = std::move(best->faces);
  s->triangle_face = std::move(best->triangle_face);
  s->tolerance_mm = best->tolerance_mm;
  return std::nullopt;
}

/// The faces that start within reach of the lowest vertex and grow over the patch.
std::expected<WedgeFaces, std::string> faces_from(const WedgePatch& patch, const FaceOptions& options,
                                                  double reach_mm, double widest_mm) {
  Search s{patch, options, {}, {}, {}, -kRimDepths * static_cast<float>(patch.depth_mm), 0, 0};
  s.faces.face.assign(patch.size(), -1);
  s.triangle_face.assign(patch.triangles.size(), -1);
  s.agreement.assign(patch.triangles.size(), 0);
  s.reach_mm = reach_mm;
  s.tolerance_mm = 1.5 * loosest_mm(patch);
  if (auto wrong = best_start(&s)) {
    return std::unexpected(*std::move(wrong));
  }
  for (int round = 0; round < kRounds; ++round) {
    s.reach_mm = std::min(s.reach_mm * kReachGrowth, widest_mm + patch.spacing_mm);
    if (!improve(&s)) {
      return std::unexpected("one of its faces has no vertices");
    }
  }
  assign(&s);
  label_vertices(&s);
  clean_labels(patch, &s.faces.face);
  drop_cleaned(&s);
  double all = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!fit_plane(s, k, &s.faces.plane[k])) {
      return std::unexpected("one of its faces has no vertices");
    }
    all += s.faces.plane[k].weight;
  }
  for (const FacePlane& plane : s.faces.plane) {
    if (plane.count < options.min_face_triangles || plane.weight < options.min_face_share * all) {
      return std::unexpected("one of its faces is too small");
    }
  }
  if (const auto wrong = meet(options, &s.faces)) {
    return std::unexpected(*wrong);
  }
  WedgeFaces refitted = refit_planes(patch, s.faces, s.tolerance_mm, s.highest, options.normal_gate_deg);
  const bool meets = !meet(options, &refitted);
  const double moved_mm = (refitted.depth_point - s.faces.depth_point).norm();
  return meets && moved_mm < kMostMoved * patch.spacing_mm ? std::move(refitted) : std::move(s.faces);
}

}  // namespace

std::expected<WedgeFaces, std::string> find_faces(const WedgePatch& patch, const FaceOptions& options) {
  double widest = 0;
  for (const Eigen::Vector3f& p : patch.p) {
    widest = std::max(widest, static_cast<double>(p.head<2>().norm()));
  }
  std::string wrong;
  double last = 0;
  for (const double depths : kReachDepths) {
    const double reach = std::min(std::max(depths * patch.depth_mm, kFirstReachSpacings * patch.spacing_mm),
                                  widest + patch.spacing_mm);
    if (reach <= 1.01 * last) {
      break;
    }
    last = reach;
    auto faces = faces_from(patch, options, reach, widest);
    if (faces) {
      return faces;
    }
    wrong = wrong.empty() ? faces.error() : wrong;
  }
  return std::unexpected(wrong);
}

}  // namespace dubsar
