// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/seam_closer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "core/parallel.h"

namespace dubsar {

namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
/// How far around the middle of an edge a choice looks, × the longest edge.
constexpr float kReachOfMost = 1.25F;

/// So far at least the third corner lies beyond an edge, × the edge's length.
constexpr float kLeastFree = 1e-3F;

struct Limits {
  float most_edge_factor;
  float least_sine;  ///< of the smallest angle
  float min_normal_cos;
  float min_crease_cos;
};

float cross2(const Vector2f& a, const Vector2f& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool segments_cross(const Vector2f& a, const Vector2f& b, const Vector2f& c, const Vector2f& d) {
  return (cross2(b - a, c - a) > 0) != (cross2(b - a, d - a) > 0) &&
         (cross2(d - c, a - c) > 0) != (cross2(d - c, b - c) > 0);
}

/// Sine of the smallest angle: the altitude on the longest side over the middle side.
float least_sine(const Vector3f& a, const Vector3f& b, const Vector3f& c) {
  float ab = (b - a).norm();
  float bc = (c - b).norm();
  float ca = (a - c).norm();
  const float area2 = (b - a).cross(c - a).norm();
  if (ab > bc) {
    std::swap(ab, bc);
  }
  if (bc > ca) {
    std::swap(bc, ca);
  }
  if (ab > bc) {
    std::swap(ab, bc);
  }
  return bc * ca > 0 ? area2 / (bc * ca) : 0.0F;
}

/// How far around the middle of an edge a choice looks. The third corner lies within the longest edge of both
/// ends; an open edge of up to 1.5 times that which crosses the triangle has an end in here.
float reach_mm(float mu, float length, float most_edge_factor) {
  return std::max(kReachOfMost * most_edge_factor * mu, 0.51F * length);
}

bool has_room(const Sheet& sheet, std::uint32_t a, std::uint32_t b, float most_edge_factor) {
  const Vector3f& pa = sheet.positions[a];
  const Vector3f& pb = sheet.positions[b];
  return sheet.has_room(0.5F * (pa + pb), reach_mm(std::max(sheet.spacing_mm[a], sheet.spacing_mm[b]),
                                                   (pb - pa).norm(), most_edge_factor));
}

struct Choice {
  std::uint32_t c = kNone;
  float key = std::numeric_limits<float>::max();  ///< smaller goes first
};

/// Looks for the third corner of a face on the free side of an open edge.
class Chooser {
 public:
  Chooser(const Front& front, const Limits& limits) : front_(&front), limits_(limits) {}

  Choice choose(std::uint32_t a, std::uint32_t b) {
    const Sheet& sheet = front_->sheet();
    const Vector3f& pa = sheet.positions[a];
    const Vector3f& pb = sheet.positions[b];
    const Vector3f middle = 0.5F * (pa + pb);
    Vector3f n = sheet.normals[a] + sheet.normals[b];
    const Vector3f ab = pb - pa;
    // Made tangent to the edge, so that the edge keeps its length in the plane.
    n -= ab * (n.dot(ab) / std::max(ab.squaredNorm(), 1e-20F));
    const float n_norm = n.norm();
    const float length = ab.norm();
    if (!(n_norm > 1e-6F) || !(length > 0)) {
      return {};
    }
    n /= n_norm;
    const Vector3f along = ab / length;
    const Vector3f free_side = along.cross(n);
    const float mu = std::max(sheet.spacing_mm[a], sheet.spacing_mm[b]);
    const float most = limits_.most_edge_factor * mu;
    const float radius = reach_mm(mu, length, limits_.most_edge_factor);
    if (!sheet.has_room(middle, radius)) {
      return {};
    }
    if (!front_->near(middle, radius, near_)) {
      return {};
    }

    layer_.resize(near_.size());
    candidates_.clear();
    for (std::size_t k = 0; k < near_.size(); ++k) {
      const Front::Links& near = *near_[k];
      const std::uint32_t v = near.vertex;
      const Vector3f d = near.position - pa;
      const float cosine = near.normal.dot(n);
      layer_[k] = cosine > std::min(0.2F, limits_.min_crease_cos) && std::abs(d.dot(n)) <= most ? 1 : 0;
      if (v == a || v == b || layer_[k] == 0 || cosine < limits_.min_crease_cos) {
        continue;
      }
      const bool is_crease = cosine < limits_.min_normal_cos;
      if (is_crease ? !(d.dot(n) < 0 && d.dot(near.normal) > 0)  // around an edge, not into a corner
                    : d.dot(free_side) < kLeastFree * length) {
        continue;
      }
      const Vector3f ca = pa - near.position;
      const Vector3f cb = pb - near.position;
      const float longest = std::max(ca.norm(), cb.norm());
      if (longest > limits_.most_edge_factor * std::max(mu, sheet.spacing_mm[v])) {
        continue;
      }
      candidates_.push_back({ca.dot(cb) / (ca.norm() * cb.norm()), k, is_crease});
    }
    std::sort(candidates_.begin(), candidates_.end(), [&](const Candidate& x, const Candidate& y) {
      return x.cosine != y.cosine ? x.cosine < y.cosine : near_[x.at]->vertex < near_[y.at]->vertex;
    });
    const Candidate* laid_for = nullptr;
    for (const Candidate& candidate : candidates_) {
      const std::uint32_t c = near_[candidate.at]->vertex;
      const Vector3f& pc = sheet.positions[c];
      const float sine = least_sine(pa, pb, pc);
      if (sine < limits_.least_sine || !front_->accepts({b, a, c})) {
        continue;
      }
      const Vector3f face_normal = (pa - pb).cross(pc - pb).normalized();
      const Vector3f measured = (sheet.normals[a] + sheet.normals[b] + sheet.normals[c]).normalized();
      if (face_normal.dot(measured) < limits_.min_normal_cos) {
        continue;
      }
      // Around an edge the plane lies aslant, or what is on its other side would lie upon itself.
      if (laid_for == nullptr || candidate.is_crease || laid_for->is_crease) {
        lay(pa, along, candidate.is_crease ? along.cross(face_normal) : free_side);
        laid_for = &candidate;
      }
      if (flat_[candidate.at].y() < kLeastFree * length || blocked(a, b, c, length, flat_[candidate.at])) {
        continue;
      }
      // Short triangles first, well shaped ones before needles of the same size.
      const float size = std::max((pc - pa).norm(), (pc - pb).norm()) / mu;
      return {c, size + 0.5F * (1.0F - sine)};
    }
    return {};
  }

 private:
  struct Candidate {
    float cosine;    ///< of the angle at the third corner
    std::size_t at;  ///< in near_
    bool is_crease;  ///< it lies on the other side of an edge of the body
  };

  [[nodiscard]] bool blocked(std::uint32_t a, std::uint32_t b, std::uint32_t c, float length,
                             const Vector2f& fc) const {
    const Vector2f fa(0, 0);
    const Vector2f fb(length, 0);
    const float slack = 1e-4F * length * length;
    for (std::size_t k = 0; k < near_.size(); ++k) {
      const std::uint32_t v = near_[k]->vertex;
      if (v == a || v == b || v == c || layer_[k] == 0) {
        continue;
      }
      const Vector2f& p = flat_[k];
      if (cross2(fb - fa, p - fa) > -slack && cross2(fc - fb, p - fb) > -slack &&
          cross2(fa - fc, p - fc) > -slack) {
        return true;
      }
    }
    const float low_x = std::min(0.0F, fc.x());
    const float high_x = std::max(length, fc.x());
    return std::any_of(segments_.begin(), segments_.end(), [&](const Segment& s) {
      if (std::max(s.tail.y(), s.head.y()) < 0 || std::min(s.tail.y(), s.head.y()) > fc.y() ||
          std::max(s.tail.x(), s.head.x()) < low_x || std::min(s.tail.x(), s.head.x()) > high_x || s.v == c ||
          s.w == c) {
        return false;
      }
      return (s.v != a && s.w != a && segments_cross(fa, fc, s.tail, s.head)) ||
             (s.v != b && s.w != b && segments_cross(fb, fc, s.tail, s.head));
    });
  }

  /// Open edges of the neighbourhood, laid into the plane.
  struct Segment {
    std::uint32_t v, w;
    Vector2f tail, head;
  };
  /// Into the plane of two axes through `origin`: what is near, and the open edges there.
  void lay(const Vector3f& origin, const Vector3f& along, const Vector3f& free_side) {
    const auto place_of = [&](const Vector3f& p) -> Vector2f {
      const Vector3f d = p - origin;
      return {d.dot(along), d.dot(free_side)};
    };
    flat_.resize(near_.size());
    segments_.clear();
    for (std::size_t k = 0; k < near_.size(); ++k) {
      if (layer_[k] == 0) {
        continue;
      }
      flat_[k] = place_of(near_[k]->position);
      for (const auto* const ends : {&near_[k]->out, &near_[k]->in}) {
        for (const std::uint32_t w : *ends) {
          segments_.push_back({near_[k]->vertex, w, flat_[k], place_of(front_->sheet().positions[w])});
        }
      }
    }
  }

  const Front* front_;
  Limits limits_;
  std::vector<const Front::Links*> near_;
  std::vector<Vector2f> flat_;
  std::vector<std::uint8_t> layer_;
  std::vector<Candidate> candidates_;
  std::vector<Segment> segments_;
};

struct Task {
  float key;
  std::uint32_t a, b, c;
  std::size_t as_of;                     ///< changes of the front when this was chosen
  bool operator<(const Task& o) const {  // the queue serves the greatest: the smallest key
    if (key != o.key) {
      return key > o.key;
    }
    return a != o.a ? a > o.a : b > o.b;
  }
};

/// Serves the queue in batches: what to do about each edge of a batch is found side by side, and done one
/// after another, but for edges near which the batch itself has changed the front: those wait for the next
/// one.
class Advance {
 public:
  Advance(Front& front, const Limits& limits, const JobContext& job)
      : front_(&front), limits_(limits), job_(&job), chooser_(front, limits) {}

  std::size_t run(const std::vector<Front::Edge>& edges) {
    offered_ = edges;
    std::size_t added = 0;
    while ((!offered_.empty() || !queue_.empty()) && !job_->cancelled()) {
      take_batch();
      choose();
      if (job_->cancelled()) {
        break;  // not all of them have been chosen for
      }
      added += apply();
    }
    return added;
  }

 private:
  static constexpr std::size_t kLeastBatch = 16, kMostBatch = 4096, kPerBatch = 512;
  static constexpr std::size_t kGrain = 32;

  void take_batch() {
    batch_.clear();
    // What is new on the front may come before all that waits.
    for (const Front::Edge& edge : offered_) {
      batch_.push_back({std::numeric_limits<float>::lowest(), edge.a, edge.b, kNone, 0});
    }
    offered_.clear();
    const std::size_t most = batch_.size() + std::clamp(queue_.size() / kPerBatch, kLeastBatch, kMostBatch);
    while (!queue_.empty() && batch_.size() < most) {
      if (front_->is_open(queue_.top().a, queue_.top().b)) {
        batch_.push_back(queue_.top());
      }
      queue_.pop();
    }
  }

  void choose() {
    choices_.resize(batch_.size());
    if (batch_.size() <= kGrain) {  // as nearly all are: with the room that the last one worked in
      choose(0, batch_.size(), chooser_);
      return;
    }
    parallel_chunks(batch_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      Chooser chooser(*front_, limits_);
      choose(begin, end, chooser);
    });
  }

  void choose(std::size_t begin, std::size_t end, Chooser& chooser) {
    for (std::size_t i = begin; i < end && !job_->cancelled(); ++i) {
      const Task& task = batch_[i];
      const bool holds = task.c != kNone && front_->last_change(around(task.a, task.b, task.c)) <= task.as_of;
      choices_[i] = holds ? Choice{task.c, task.key} : chooser.choose(task.a, task.b);
    }
  }

  std::size_t apply() {
    const std::size_t before = front_->changes();
    for (std::size_t i = 0; i < batch_.size(); ++i) {
      const Task& task = batch_[i];
      const Choice& now = choices_[i];
      if (now.c == kNone) {
        continue;
      }
      if (task.c == kNone || (now.c != task.c && now.key > task.key)) {
        queue_.push({now.key, task.a, task.b, now.c, before});
        continue;
      }
      if (front_->last_change(around(task.a, task.b, now.c)) > before) {
        queue_.push({task.key, task.a, task.b, now.c, 0});
        continue;
      }
      front_->add_face({task.b, task.a, now.c});
      // The face's other half-edges are a→c and c→b; they are new front where nothing lay beyond.
      if (front_->is_open(task.a, now.c)) {
        offered_.push_back({task.a, now.c});
      }
      if (front_->is_open(now.c, task.b)) {
        offered_.push_back({now.c, task.b});
      }
    }
    return front_->changes() - before;
  }

  /// What a choice depends on lies in here.
  [[nodiscard]] Eigen::AlignedBox3f around(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Sheet& sheet = front_->sheet();
    Eigen::AlignedBox3f box(sheet.positions[a]);
    box.extend(sheet.positions[b]);
    box.extend(sheet.positions[c]);
    const float margin =
        kReachOfMost * limits_.most_edge_factor * std::max(sheet.spacing_mm[a], sheet.spacing_mm[b]);
    box.min().array() -= margin;
    box.max().array() += margin;
    return box;
  }

  Front* front_;
  Limits limits_;
  const JobContext* job_;
  Chooser chooser_;
  std::priority_queue<Task> queue_;
  std::vector<Front::Edge> offered_;
  std::vector<Task> batch_;
  std::vector<Choice> choices_;
};

}  // namespace

namespace {

Limits limits_of(const SeamOptions& options, double most_edge_factor, double least_angle_rad) {
  return {static_cast<float>(most_edge_factor), static_cast<float>(std::sin(least_angle_rad)),
          static_cast<float>(options.min_normal_cos), static_cast<float>(options.min_crease_cos)};
}

}  // namespace

std::size_t close_seams(Front& front, const SeamOptions& options, const JobContext& job) {
  return Advance(front, limits_of(options, options.most_edge_factor, options.least_angle_rad), job)
      .run(front.open_edges());
}

std::vector<Front::Edge> edges_without_room(const Front& front, const SeamOptions& options) {
  std::vector<Front::Edge> edges = front.open_edges();
  std::erase_if(edges, [&](const Front::Edge& edge) {
    return has_room(front.sheet(), edge.a, edge.b, static_cast<float>(options.most_edge_factor));
  });
  return edges;
}

std::size_t close_openings(Front& front, const std::vector<std::vector<std::uint32_t>>& openings,
                           double least_angle_rad, const SeamOptions& options, const JobContext& job) {
  std::vector<Front::Edge> edges;
  for (const auto& loop : openings) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      edges.push_back({loop[i], loop[(i + 1) % loop.size()]});
    }
  }
  return Advance(front, limits_of(options, options.most_gap_edge_factor, least_angle_rad), job).run(edges);
}

}  // namespace dubsar
