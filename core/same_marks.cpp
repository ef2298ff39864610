// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/same_marks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <vector>

#include "core/random.h"

namespace dubsar {

namespace {

/// So many are found, and this part of all: of independent scans, simulated and real, no six were. Rounding
/// makes other samples stand out most; points that were put into rows and columns anew have lost some, and
/// with each the marks beside it.
constexpr std::size_t kLeastFound = 12;
constexpr double kLeastShareFound = 0.1;
/// So many marks of `part` have one that was found in their cell, or in one beside it, of those that no edge
/// has made and of all; cells are as wide as this where all are found, wider where fewer are.
constexpr double kLeastShareCovered = 0.9;
constexpr double kLeastOfAllCovered = 0.85;
constexpr double kCoverSpacings = 8.0;
/// Of fewer marks than this so many of those that no edge has made are found themselves, or of all where
/// these are too few: cells say little of so small a scan.
constexpr std::size_t kManyMarks = 100;
constexpr double kLeastShareOfFew = 0.9;
constexpr double kLeastShareOfAllFew = 0.75;
/// Differences of copies are no more than so many times their RMS.
constexpr double kMostOfRounding = 4.0;

/// Marks that are tried to find the motion, and pairs of them.
constexpr std::size_t kProbes = 256;
constexpr int kTrials = 400;
constexpr int kThirds = 20;
/// Marks as near to each other as this fix no motion, in the most that they may be off.
constexpr double kLeastBase = 20.0;

struct Match {
  Eigen::Vector3d from, to;
};

float stands_out(const ScanMark& mark) {
  return mark.shape[0];
}

/// Calls each(mark, off) with the marks that look like this one; off: by how much they do not, mm.
template <class Each>
void for_each_alike(const ScanMarks& in, const ScanMark& like, float within_mm, const Each& each) {
  auto at = std::ranges::lower_bound(in.marks, like.shape[0] - within_mm, {}, stands_out);
  for (; at != in.marks.end() && at->shape[0] <= like.shape[0] + within_mm; ++at) {
    float off_mm = 0;
    for (std::size_t k = 0; k < like.shape.size() && off_mm <= within_mm; ++k) {
      off_mm = std::max(off_mm, std::abs(at->shape[k] - like.shape[k]));
    }
    if (off_mm <= within_mm) {
      each(*at, off_mm);
    }
  }
}

/// Marks of `part`, each with the one of `whole` that looks most like it. Of many those that stand out far:
/// fewer look alike.
std::vector<Match> likeliest(const ScanMarks& whole, const ScanMarks& part, float within_mm) {
  std::vector<Match> out;
  const std::size_t count = part.marks.size();
  const std::size_t first = count > 2 * kProbes ? count / 2 : 0;
  const std::size_t step = std::max<std::size_t>(1, (count - first) / kProbes);
  for (std::size_t k = first; k < count; k += step) {
    const ScanMark* best = nullptr;
    float least_mm = 0;
    for_each_alike(whole, part.marks[k], within_mm, [&](const ScanMark& mark, float off_mm) {
      if (best == nullptr || off_mm < least_mm) {
        best = &mark;
        least_mm = off_mm;
      }
    });
    if (best != nullptr) {
      out.push_back({part.marks[k].at_mm.cast<double>(), best->at_mm.cast<double>()});
    }
  }
  return out;
}

/// Least squares (Umeyama 1991), without a scale.
RigidTransform motion_of(const std::vector<Match>& matches) {
  Eigen::Matrix3Xd from(3, static_cast<Eigen::Index>(matches.size()));
  Eigen::Matrix3Xd to = from;
  for (std::size_t k = 0; k < matches.size(); ++k) {
    from.col(static_cast<Eigen::Index>(k)) = matches[k].from;
    to.col(static_cast<Eigen::Index>(k)) = matches[k].to;
  }
  const Eigen::Matrix4d motion = Eigen::umeyama(from, to, false);
  RigidTransform out;
  out.rotation = motion.topLeftCorner<3, 3>();
  out.translation_mm = motion.topRightCorner<3, 1>();
  return out;
}

std::vector<Match> that_agree(const std::vector<Match>& matches, const RigidTransform& motion,
                              double within_mm) {
  std::vector<Match> out;
  std::ranges::copy_if(matches, std::back_inserter(out), [&](const Match& match) {
    return (motion * match.from - match.to).norm() <= within_mm;
  });
  return out;
}

/// The matches that one motion explains, by trial: three that keep their distances give one.
std::vector<Match> explained(const std::vector<Match>& matches, double most_mm) {
  const auto keep_distance = [&](const Match& a, const Match& b) {
    const double there_mm = (a.to - b.to).norm();
    return there_mm > kLeastBase * most_mm && std::abs((a.from - b.from).norm() - there_mm) <= 2 * most_mm;
  };
  Random random(matches.size());
  const auto any = [&]() -> const Match& { return matches[random.below(matches.size())]; };
  std::vector<Match> best;
  for (int trial = 0; trial < kTrials && best.size() < std::max(kLeastFound, matches.size() / 3); ++trial) {
    const Match& a = any();
    const Match& b = any();
    if (!keep_distance(a, b)) {
      continue;
    }
    for (int third = 0; third < kThirds; ++third) {
      const Match& c = any();
      if (keep_distance(a, c) && keep_distance(b, c)) {
        std::vector<Match> agree = that_agree(matches, motion_of({a, b, c}), 4 * most_mm);
        if (agree.size() > best.size()) {
          best = std::move(agree);
        }
        break;
      }
    }
  }
  return best;
}

/// Cubes that hold one of the places.
class Cover {
 public:
  Cover(const std::vector<Eigen::Vector3f>& places_mm, double cell_mm) : per_mm_(1 / cell_mm) {
    for (const Eigen::Vector3f& place : places_mm) {
      cells_.push_back(cell_of(place));
    }
    std::ranges::sort(cells_);
    cells_.erase(std::ranges::unique(cells_).begin(), cells_.end());
  }
  /// Whether the place's cube is one, or one beside it is.
  [[nodiscard]] bool is_near(const Eigen::Vector3f& place_mm) const {
    const Cell own = cell_of(place_mm);
    for (std::int64_t x = -1; x <= 1; ++x) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        for (std::int64_t z = -1; z <= 1; ++z) {
          if (std::ranges::binary_search(cells_, Cell{own[0] + x, own[1] + y, own[2] + z})) {
            return true;
          }
        }
      }
    }
    return false;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  [[nodiscard]] Cell cell_of(const Eigen::Vector3f& place_mm) const {
    const auto along = [&](float mm) {
      return static_cast<std::int64_t>(std::floor(per_mm_ * static_cast<double>(mm)));
    };
    return {along(place_mm.x()), along(place_mm.y()), along(place_mm.z())};
  }

  double per_mm_;
  std::vector<Cell> cells_;
};

/// Whether what was found of the marks lies all over them.
bool is_nearly_all(std::span<const ScanMark> marks, const std::vector<std::uint8_t>& is_found,
                   double spacing_mm) {
  std::vector<Eigen::Vector3f> found;
  double found_inside = 0;
  double inside = 0;
  for (std::size_t k = 0; k < is_found.size(); ++k) {
    const ScanMark& mark = marks[k];
    inside += mark.is_inside ? 1 : 0;
    if (is_found[k] != 0) {
      found.push_back(mark.at_mm);
      found_inside += mark.is_inside ? 1 : 0;
    }
  }
  const auto count = static_cast<double>(found.size());
  const auto all = static_cast<double>(marks.size());
  const bool is_most =
      inside < kLeastFound ? count >= kLeastShareOfAllFew * all : found_inside >= kLeastShareOfFew * inside;
  if (found.size() < kLeastFound || count < kLeastShareFound * all ||
      (marks.size() < kManyMarks && !is_most)) {
    return false;
  }
  const Cover cover(found, kCoverSpacings * spacing_mm * std::sqrt(all / count));
  double covered = 0;
  double covered_inside = 0;
  for (const ScanMark& mark : marks) {
    if (cover.is_near(mark.at_mm)) {
      covered += 1;
      covered_inside += mark.is_inside ? 1 : 0;
    }
  }
  return covered >= kLeastOfAllCovered * all && covered_inside >= kLeastShareCovered * inside;
}

/// Whether the marks of `part` are those of `whole` there.
bool are_the_same(const ScanMarks& whole, const ScanMarks& part, const RigidTransform& motion,
                  double rounding_mm) {
  const double most_mm = kMostOfRounding * rounding_mm;
  const double most2 = 3 * most_mm * most_mm;
  // What stands out less may be a mark of the part alone.
  const std::span<const ScanMark> marks(
      std::ranges::lower_bound(part.marks, static_cast<float>(whole.least_mm + most_mm), {}, stands_out),
      part.marks.end());
  std::vector<std::uint8_t> is_found(marks.size(), 0);
  double sum2 = 0;
  double count = 0;
  for (std::size_t k = 0; k < is_found.size(); ++k) {
    const ScanMark& mark = marks[k];
    const Eigen::Vector3d there = motion * mark.at_mm.cast<double>();
    double nearest2 = 2 * most2;
    for_each_alike(whole, mark, static_cast<float>(most_mm), [&](const ScanMark& other, float) {
      nearest2 = std::min(nearest2, (other.at_mm.cast<double>() - there).squaredNorm());
    });
    if (nearest2 <= most2) {
      is_found[k] = 1;
      sum2 += nearest2;
      count += 1;
    }
  }
  return sum2 <= 3 * rounding_mm * rounding_mm * count && is_nearly_all(marks, is_found, part.spacing_mm);
}

}  // namespace

std::optional<RigidTransform> whole_from_part(const ScanMarks& whole, const ScanMarks& part) {
  if (std::min(whole.marks.size(), part.marks.size()) < kLeastFound) {
    return std::nullopt;
  }
  const double rounding_mm = std::min(whole.rounding_mm, part.rounding_mm);
  const double most_mm = kMostOfRounding * rounding_mm;
  const std::vector<Match> matches = likeliest(whole, part, static_cast<float>(most_mm));
  if (matches.size() < kLeastFound) {
    return std::nullopt;
  }
  RigidTransform motion;
  std::vector<Match> agree = explained(matches, most_mm);
  for (int round = 0; round < 2; ++round) {
    if (agree.size() < kLeastFound / 2) {
      return std::nullopt;
    }
    motion = motion_of(agree);
    agree = that_agree(matches, motion, 2 * most_mm);
  }
  return are_the_same(whole, part, motion, rounding_mm) ? std::optional(motion) : std::nullopt;
}

}  // namespace dubsar
