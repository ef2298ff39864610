// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/fusion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/parallel.h"
#include "triangulation/line_projection.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

float square(float x) {
  return x * x;
}

/// What the passes of one scan weigh together: they err by the same pose.
struct SharedPose {
  int id;
  float weight;

  /// Twice the weighted covariance of one more pass with those so far; 0 for another scan, which comes in
  /// their place.
  [[nodiscard]] float covariance_with(const StitchSurface& s, float s_weight) {
    const float so_far = s.id == id ? weight : 0.0F;
    id = s.id;
    weight = so_far + s_weight;
    return so_far == 0 ? 0.0F : 2 * so_far * s_weight * s.pose_variance_mm2();
  }
};

/// How much of its say a sample keeps that is so far from the rim of its scan.
float faded(std::uint8_t rim, float feather) {
  if (feather <= 0) {
    return 1.0F;
  }
  // Never quite nothing: a sample that no other scan supports stays where it was measured.
  const float part = std::clamp((static_cast<float>(rim) - 1.0F) / feather, 0.0F, 1.0F);
  return std::max(part * part, 1e-4F);
}

/// Pairs::feather, longer where one of the two hardly counts beside the other: it takes over only where the
/// other has all but faded out, and so short a way would show the step. None where both are taken to one
/// place.
float feather_between(const StitchSurface& a, const StitchSurface& b, const Pairs& pairs) {
  const auto [least, most] = std::minmax(a.pose_share, b.pose_share);
  if (!pairs.onto.is_none()) {
    return 0;
  }
  return std::min(pairs.feather * std::sqrt(most / least), static_cast<float>(kMostRim - 1));
}

/// Along which a sample moves: towards the laser. It is known to lie on the laser's ray, and errs along it,
/// so samples keep the order that they have in the grid, and no cell is folded over however noisy they are;
/// the normal of one sample is noisy, too. On a surface that the laser only grazes, along the normal all the
/// same: there a ray hardly comes nearer to where the others have the surface. So, too, where the laser's
/// place is not known.
Vector3f averaging_direction(const StitchSurface& from, int row, const Vector3f& p, const Vector3f& normal) {
  constexpr float kLeastCos = 0.3F;
  if (!from.view.laser_mm) {
    return normal;
  }
  const Vector3f ray = from.view.to_laser(p.cast<double>(), row).cast<float>();
  return ray.dot(normal) > kLeastCos ? ray : normal;
}

/// Averages samples of a scan, one after the other. What those of one node share is worked out once.
class Averager {
 public:
  Averager(const StitchSurface& from, std::span<const StitchSurface* const> others,
           std::span<const Pairs* const> pairs)
      : from_(from),
        others_(others),
        pairs_(pairs),
        own_pose_variance_mm2_(from.pose_variance_mm2()),
        node_(from.lattice.size()) {}

  /// The sample out.samples[at], into the other arrays of `out`.
  void average(std::size_t at, FusedSamples& out);

 private:
  /// The line on which a sample moves.
  struct Course {
    std::size_t sample = 0;
    Vector3f normal;
    Line line;
    float tilt = 1;    ///< × a distance along the line: the distance along the normal
    float weight = 0;  ///< of the sample itself in the average
  };
  /// One of the others around a node: where to look from there, and what is the same for all that is found.
  struct Start {
    std::size_t other = 0;
    PairStart pair;
    float feather = 0;
    float pose_variance_mm2 = 0;
  };
  /// Where the line meets one of the others.
  struct Found {
    std::size_t other = 0;
    float weight = 0;    ///< in the average
    float variance = 0;  ///< of the place along the normal
    Projection at;
  };

  void enter(std::size_t node);
  [[nodiscard]] Projection meeting(const Course& course, const PairStart& start, std::size_t other) const;
  [[nodiscard]] float own_weight(std::size_t sample) const {
    return from_.weight(sample) * from_.pose_share * faded(from_.rim[sample], feather_);
  }
  void write_average(const Course& course, std::size_t at, FusedSamples& out) const;
  [[nodiscard]] float moved2_mm2(const Course& course, float weight_sum) const;
  [[nodiscard]] float sigma_mm(const Course& course, float shift_mm, float weight_sum) const;

  const StitchSurface& from_;
  std::span<const StitchSurface* const> others_;
  std::span<const Pairs* const> pairs_;  ///< with each of the others
  float own_pose_variance_mm2_;
  std::size_t node_;
  std::vector<Start> starts_;  ///< of the node
  float feather_ = 0;          ///< the widest of those with them
  std::vector<Found> found_;   ///< of the sample
};

void Averager::enter(std::size_t node) {
  node_ = node;
  starts_.clear();
  feather_ = 0;
  for (std::size_t k = 0; k < others_.size(); ++k) {
    if (const PairStart start = pair_start(from_, node, *others_[k], *pairs_[k]); start.sample >= 0) {
      starts_.push_back(
          {k, start, feather_between(from_, *others_[k], *pairs_[k]), others_[k]->pose_variance_mm2()});
      feather_ = std::max(feather_, starts_.back().feather);
    }
  }
}

/// Where the line meets the other scan's surface within reach; of weight 0 where it does not.
Projection Averager::meeting(const Course& course, const PairStart& start, std::size_t other) const {
  const StitchSurface& on = *others_[other];
  const Pairs& pairs = *pairs_[other];
  const auto within_reach = [&](const Projection& q) {
    return course.tilt * std::abs(q.along_mm) <= pairs.reach_mm;
  };
  Line line = course.line;
  line.p = pairs.on_other(line.p);
  const auto [row, col] = start.place_of(line.p);
  Projection q = project(line, on, row, col);
  if (q.weight > 0 && !(within_reach(q) && course.normal.dot(q.normal) > pairs.min_normal_cos)) {
    // Another fold of the surface: from the nearest sample that looks the same way there is a way to the
    // right one.
    const std::int64_t j = pair_of(from_, course.sample, start, on, pairs);
    q = j < 0 ? Projection()
              : project(line, on, static_cast<float>(on.lattice.sample_row(static_cast<std::size_t>(j))),
                        static_cast<float>(on.lattice.sample_col(static_cast<std::size_t>(j))));
  }
  return within_reach(q) ? q : Projection();
}

void Averager::write_average(const Course& course, std::size_t at, FusedSamples& out) const {
  const std::size_t i = course.sample;
  float shift_sum = 0;
  float weight_sum = course.weight;
  float best = from_.reliability(i);  // of a scan's passes: they look from one place
  for (const Found& found : found_) {
    best = others_[found.other]->id == from_.id ? std::max(best, found.at.reliability) : best;
  }
  float doubt = 1.0F - best;
  float doubt_before = doubt;  // without the scan whose passes come
  bool sparse = from_.is_sparse(i);
  std::size_t scans = 1;
  int last = from_.id;
  for (const auto& [k, weight, variance, q] : found_) {
    const int id = others_[k]->id;
    if (id != last && id != from_.id) {  // passes of one scan follow each other
      ++scans;
      doubt_before = doubt;
      best = 0;
    }
    if (id != from_.id) {
      best = std::max(best, q.reliability);
      doubt = doubt_before * (1.0F - best);
    }
    last = id;
    shift_sum += weight * q.along_mm;
    weight_sum += weight;
    sparse = sparse && !q.well_sampled;
  }
  const float shift_mm = shift_sum / weight_sum;
  out.points[at] = from_.moved_back(course.line.p) + shift_mm * course.line.n;
  out.sigma_mm[at] = sigma_mm(course, shift_mm, weight_sum);
  const float off2 = square(out.sigma_mm[at]) + moved2_mm2(course, weight_sum);
  out.reliability[at] = (1.0F - doubt) / (1.0F + off2 / square(static_cast<float>(from_.spacing_mm)));
  out.sparse[at] = sparse ? 1 : 0;
  out.scans[at] = static_cast<std::uint8_t>(std::min<std::size_t>(scans, 255));
}

/// How far scans have been taken along the normal, as their errors would average: that they fit there is no
/// proof of it.
float Averager::moved2_mm2(const Course& course, float weight_sum) const {
  const auto moved2 = [&](const StitchSurface& s, float weight) {
    return s.back.is_none() ? 0.0F : square(weight * s.back.at(course.line.p).dot(course.normal));
  };
  float sum = moved2(from_, course.weight);
  for (const Found& found : found_) {
    sum += moved2(*others_[found.other], found.weight);
  }
  return sum / square(weight_sum);
}

/// Of the average: noise and poses of different scans are independent, passes of one scan share its pose, and
/// where the clay bends all other scans' triangles lie to the same side of it.
float Averager::sigma_mm(const Course& course, float shift_mm, float weight_sum) const {
  const float own_variance = from_.variance_of_weight / from_.weight(course.sample) + own_pose_variance_mm2_;
  const float own_part = course.weight;
  float variance_sum = square(own_part) * own_variance;
  SharedPose own_pose{from_.id, own_part};
  SharedPose last_pose{from_.id, 0};
  float bulge_sum = 0;
  float chi2 = 0;
  for (const auto& [k, weight, variance, q] : found_) {
    variance_sum += square(weight) * variance;
    SharedPose& pose = others_[k]->id == from_.id ? own_pose : last_pose;
    variance_sum += pose.covariance_with(*others_[k], weight);
    bulge_sum += weight * std::abs(q.bulge_mm);
    chi2 += square(course.tilt * (q.along_mm - shift_mm)) / (variance + square(q.bulge_mm));
  }
  // That it stands off by as much says nothing against the sample.
  chi2 += square(course.tilt * shift_mm) / (own_variance + square(bulge_sum / weight_sum));
  const float excess = found_.empty() ? 1.0F : std::max(1.0F, chi2 / static_cast<float>(found_.size()));
  const float alone = excess * (variance_sum + square(bulge_sum)) / square(weight_sum);
  return std::sqrt(alone + from_.together_variance_mm2);
}

void Averager::average(std::size_t at, FusedSamples& out) {
  const std::size_t i = out.samples[at];
  if (from_.lattice.node_of(i) != node_) {
    enter(from_.lattice.node_of(i));
  }
  const Vector3f& p = from_.points[i];
  const Vector3f normal = from_.normal(i);
  const Vector3f along = averaging_direction(from_, from_.lattice.sample_row(i), p, normal);
  const Course course{i, normal, Line(p, along), along.dot(normal), own_weight(i)};
  found_.clear();
  for (const Start& start : starts_) {
    if (const Projection q = meeting(course, start.pair, start.other); q.weight > 0) {
      const StitchSurface& on = *others_[start.other];
      found_.push_back({start.other, q.weight * on.pose_share * faded(q.rim, start.feather),
                        on.variance_of_weight / q.weight + start.pose_variance_mm2, q});
    }
  }
  write_average(course, at, out);
}

}  // namespace

FusedSamples::FusedSamples(const StitchSurface& of) : slot(of.points.size(), kNone) {}

void FusedSamples::forget_if(const std::function<bool(std::uint32_t)>& gone) {
  // Mostly all stay.
  const std::size_t first = parallel_reduce_ordered(
      samples.size(), 16384, samples.size(),
      [&](std::size_t begin, std::size_t end) {
        while (begin < end && !gone(samples[begin])) {
          ++begin;
        }
        return begin < end ? begin : samples.size();
      },
      [](std::size_t& total, std::size_t part) { total = std::min(total, part); });
  std::size_t out = first;
  for (std::size_t at = first; at < samples.size(); ++at) {
    const std::uint32_t i = samples[at];
    if (gone(i)) {
      slot[i] = kNone;
      continue;
    }
    slot[i] = static_cast<std::uint32_t>(out);
    samples[out] = i;
    points[out] = points[at];
    reliability[out] = reliability[at];
    sigma_mm[out] = sigma_mm[at];
    sparse[out] = sparse[at];
    scans[out++] = scans[at];
  }
  resize(out);
}

void FusedSamples::forget_from(std::size_t first) {
  for (std::size_t at = first; at < samples.size(); ++at) {
    slot[samples[at]] = kNone;
  }
  resize(first);
}

void FusedSamples::resize(std::size_t count) {
  samples.resize(count);
  points.resize(count);
  reliability.resize(count);
  sigma_mm.resize(count);
  sparse.resize(count);
  scans.resize(count);
}

void fuse(const StitchSurface& from, std::span<const StitchSurface* const> others,
          std::span<const Pairs* const> pairs, std::span<const std::uint32_t> which, FusedSamples& out,
          const JobContext& job) {
  const std::size_t first = out.samples.size();
  out.samples.insert(out.samples.end(), which.begin(), which.end());
  out.resize(out.samples.size());
  parallel_chunks(which.size(), 2048, [&](std::size_t begin, std::size_t end) {
    Averager averager(from, others, pairs);
    for (std::size_t at = first + begin; at < first + end && !job.cancelled(); ++at) {
      out.slot[out.samples[at]] = static_cast<std::uint32_t>(at);
      averager.average(at, out);
    }
  });
  if (job.cancelled()) {
    out.forget_from(first);
  }
}

}  // namespace dubsar
