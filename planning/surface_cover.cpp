// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/surface_cover.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>

#include "core/parallel.h"
#include "core/units.h"
#include "planning/clearing.h"

namespace dubsar {

namespace {

constexpr double kCellInSpacings = 1.5;
constexpr double kLeastCellMm = 0.15;
constexpr int kSectors = 12;
constexpr int kEmptySectorsOfRim = 4;
/// Beside a round hole of 4 to 6 µ fewer are empty. As few are at the edges of wedges, where the surface
/// bends: such an element is a rim where others like it stand around the same bare disc.
constexpr int kEmptySectorsOfSmallRim = 3;
constexpr float kDiscMiddleInCells = 1.5F;
constexpr float kBareDiscInCells = 1.2F;
constexpr float kRingInCells = 3.3F;  ///< how far from there its rims are looked for
constexpr int kLeastInRing = 6;
constexpr int kMostEmptySectorsOfRing = 4;
constexpr float kFacesMiddleCosine = 0.5F;
constexpr std::int64_t kMostCoarseCells = 16'000'000;

/// Normals this far apart, 135°, and behind: of thin clay the other side, which says nothing of this one.
/// Less is the far flank of a ridge, where the surface goes on.
constexpr float kOtherSideCosine = -0.70710678F;
bool is_other_side(const Eigen::Vector3f& normal, const SurfaceCover::Element& e,
                   const Eigen::Vector3f& to_it) {
  return normal.dot(e.normal) < kOtherSideCosine && normal.dot(to_it) < 0;
}

/// Twelfth of a turn that (a, b) lies in, without trigonometry.
unsigned sector_of(float a, float b) {
  constexpr float kTan30 = 0.57735027F;
  constexpr float kTan60 = 1.7320508F;
  const float x = std::abs(a);
  const float y = std::abs(b);
  const unsigned third = y < kTan30 * x ? 0U : y < kTan60 * x ? 1U : 2U;
  if (b >= 0) {
    return a >= 0 ? third : 5U - third;
  }
  return a < 0 ? 6U + third : 11U - third;
}

/// The longest run of sectors, round the turn, that a set of them leaves empty, and the last sector of it.
struct EmptyRun {
  std::int8_t longest = 0;
  std::int8_t last = 0;
};
constexpr std::array<EmptyRun, 1U << kSectors> empty_runs() {
  std::array<EmptyRun, 1U << kSectors> out{};
  for (unsigned seen = 0; seen < out.size(); ++seen) {
    int run = 0;
    for (int k = 0; k < 2 * kSectors && out[seen].longest < kSectors; ++k) {
      run = (seen >> static_cast<unsigned>(k % kSectors) & 1U) == 0 ? run + 1 : 0;
      if (run > out[seen].longest) {
        out[seen] = {static_cast<std::int8_t>(run), static_cast<std::int8_t>(k)};
      }
    }
  }
  return out;
}
constexpr std::array<EmptyRun, 1U << kSectors> kRunOfEmpty = empty_runs();

}  // namespace

SurfaceCover::SurfaceCover(std::span<const PlacedScan> scans) : levels_(scans) {
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    cells_mm_.push_back(std::max(kLeastCellMm, kCellInSpacings * levels_.spacing_mm(level)));
  }
  std::vector<std::vector<Element>> by_scan(scans.size());
  parallel_for_each_index(
      scans.size(),
      [&](std::size_t s) {
        const std::uint8_t level = levels_.of_scan(s);
        by_scan[s] = elements_of(scans[s], cells_mm_[level]);
        for (Element& e : by_scan[s]) {
          e.level = level;
        }
      },
      1);
  thin(by_scan);
  sort_into_cells();
  part_cells();
  note_coarse(scans);
  find_rims(scans);
}

void SurfaceCover::thin(const std::vector<std::vector<Element>>& by_scan) {
  std::size_t count = 0;
  Eigen::AlignedBox3f box;
  for (const auto& elements : by_scan) {
    count += elements.size();
    for (const Element& e : elements) {
      box.extend(e.position_mm);
    }
  }
  if (box.isEmpty()) {
    return;
  }
  low_ = box.min();
  // Each level by itself: a fine element must not take the place of one that reaches farther.
  std::vector<CellSet> occupied(1, CellSet(count));
  for (std::size_t level = 1; level < levels_.size(); ++level) {
    std::size_t of_level = 0;
    for (std::size_t s = 0; s < by_scan.size(); ++s) {
      of_level += levels_.of_scan(s) == level ? by_scan[s].size() : 0;
    }
    occupied.emplace_back(of_level);
  }
  for (const auto& elements : by_scan) {
    for (const Element& e : elements) {
      const auto per_mm = static_cast<float>(1.0 / cells_mm_[e.level]);
      std::uint64_t key = 0;
      for (int k = 0; k < 3; ++k) {
        const float at = std::clamp((e.position_mm[k] - low_[k]) * per_mm, 0.0F, 1048575.0F);
        key = (key << 20U) | static_cast<std::uint64_t>(at);
      }
      if (occupied[e.level].insert(key)) {
        elements_.push_back(e);
      }
    }
  }
}

std::size_t SurfaceCover::cell_index(const Eigen::Vector3f& p) const {
  std::size_t index = 0;
  for (std::size_t k = 3; k-- > 0;) {
    const auto at =
        static_cast<std::int64_t>((p[static_cast<int>(k)] - low_[static_cast<int>(k)]) / coarse_mm_);
    index = index * static_cast<std::size_t>(size_[k]) +
            static_cast<std::size_t>(std::clamp<std::int64_t>(at, 0, size_[k] - 1));
  }
  return index;
}

void SurfaceCover::sort_into_cells() {
  Eigen::AlignedBox3f box;
  for (const Element& e : elements_) {
    box.extend(e.position_mm);
  }
  coarse_mm_ = static_cast<float>(reach_mm());
  if (!box.isEmpty()) {
    const auto cells = [&] {
      for (std::size_t k = 0; k < 3; ++k) {
        size_[k] = static_cast<std::int64_t>(box.sizes()[static_cast<int>(k)] / coarse_mm_) + 1;
      }
      return static_cast<double>(size_[0]) * static_cast<double>(size_[1]) * static_cast<double>(size_[2]);
    };
    while (cells() > static_cast<double>(kMostCoarseCells)) {
      coarse_mm_ *= 1.25F;
    }
  }
  start_.assign(static_cast<std::size_t>(size_[0] * size_[1] * size_[2]) + 1, 0);
  for (const Element& e : elements_) {
    ++start_[cell_index(e.position_mm) + 1];
  }
  for (std::size_t i = 1; i < start_.size(); ++i) {
    start_[i] += start_[i - 1];
  }
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  std::vector<Element> sorted(elements_.size());
  for (const Element& e : elements_) {
    sorted[next[cell_index(e.position_mm)]++] = e;
  }
  elements_ = std::move(sorted);
}

template <class Visit>
void SurfaceCover::for_each_near(const Eigen::Vector3f& p, float radius, const Visit& visit) const {
  std::array<std::int64_t, 3> from{};
  std::array<std::int64_t, 3> to{};
  for (std::size_t k = 0; k < 3; ++k) {
    const float at = p[static_cast<int>(k)] - low_[static_cast<int>(k)];
    from[k] = static_cast<std::int64_t>(std::floor(std::clamp((at - radius) / coarse_mm_, -1.0F, 1e9F)));
    to[k] = static_cast<std::int64_t>(std::floor(std::clamp((at + radius) / coarse_mm_, -1.0F, 1e9F)));
    from[k] = std::max<std::int64_t>(from[k], 0);
    to[k] = std::min(to[k], size_[k] - 1);
  }
  for (std::int64_t z = from[2]; z <= to[2]; ++z) {
    for (std::int64_t y = from[1]; y <= to[1]; ++y) {
      const std::int64_t line = (z * size_[1] + y) * size_[0];
      if (from[0] > to[0]) {
        continue;
      }
      const std::uint32_t end = start_[static_cast<std::size_t>(line + to[0]) + 1];
      for (std::uint32_t i = start_[static_cast<std::size_t>(line + from[0])]; i < end; ++i) {
        const Eigen::Vector3f d = elements_[i].position_mm - p;
        const float d2 = d.squaredNorm();
        if (d2 <= radius * radius) {
          if (visit(i, d, d2)) {
            return;
          }
        }
      }
    }
  }
}

std::vector<std::uint8_t> SurfaceCover::suspect_cells(std::span<const PlacedScan> scans) const {
  // The cells of each scan's sparse samples, once each; then the cells around them.
  std::vector<std::vector<Eigen::Vector3f>> places(scans.size());
  parallel_for_each_index(
      scans.size(),
      [&](std::size_t s) {
        const PlacedScan& scan = scans[s];
        const Eigen::Matrix3f rotation = scan.model_from_scanner.rotation.cast<float>();
        const Eigen::Vector3f translation = scan.model_from_scanner.translation_mm.cast<float>();
        std::size_t last = start_.size();
        for (std::size_t i = 0; i < scan.grid->size(); ++i) {
          if (((*scan.flags)[i] & (kSparse | kNotTablet)) != kSparse || scan.grid->valid[i] == 0) {
            continue;
          }
          const Eigen::Vector3f p = rotation * scan.grid->point(i) + translation;
          const std::size_t cell = cell_index(p);
          if (cell != last) {
            places[s].push_back(p);
            last = cell;
          }
        }
      },
      1);
  std::vector<std::uint8_t> suspect(start_.size(), 0);
  // A whole cell, which is larger than the reach where the box is: one sample speaks for all of its cell.
  const float far = coarse_mm_;
  for (const Eigen::Vector3f& p : places | std::views::join) {
    if (suspect[cell_index(p)] == 2) {
      continue;  // its surroundings are marked
    }
    for (int n = 0; n < 27; ++n) {
      const Eigen::Vector3f step(static_cast<float>(n % 3 - 1), static_cast<float>(n / 3 % 3 - 1),
                                 static_cast<float>(n / 9 - 1));
      std::uint8_t& mark = suspect[cell_index(p + far * step)];
      mark = std::max<std::uint8_t>(mark, n == 13 ? 2 : 1);
    }
  }
  return suspect;
}

void SurfaceCover::find_rims(std::span<const PlacedScan> scans) {
  const std::vector<std::uint8_t> suspect = suspect_cells(scans);
  is_rim_.assign(elements_.size(), kNoRim);
  std::vector<Eigen::Vector3f> outward(elements_.size());
  parallel_for_each_index(
      elements_.size(),
      [&](std::size_t i) {
        const Element& here = elements_[i];
        if (suspect[cell_index(here.position_mm)] == 0) {
          return;
        }
        const auto radius = static_cast<float>(kReachInCells * cells_mm_[here.level]);
        const auto nearest2 = static_cast<float>(std::pow(0.3 * cells_mm_[here.level], 2.0));
        const Eigen::Vector3f u = here.normal.unitOrthogonal();
        const Eigen::Vector3f v = here.normal.cross(u);
        unsigned seen = 0;
        for_each_near(here.position_mm, radius, [&](std::uint32_t j, const Eigen::Vector3f& d, float d2) {
          if (d2 < nearest2 || is_other_side(here.normal, elements_[j], d)) {
            return false;
          }
          const float a = u.dot(d);
          const float b = v.dot(d);
          // What lies straight above or below says nothing about the side.
          if (a * a + b * b < 0.03F * d2) {
            return false;
          }
          seen |= 1U << sector_of(a, b);
          return kRunOfEmpty[seen].longest <
                 kEmptySectorsOfSmallRim;  // whatever else lies around, it is none
        });
        const auto [longest, last] = kRunOfEmpty[seen];
        if (longest >= kEmptySectorsOfSmallRim) {
          is_rim_[i] = longest >= kEmptySectorsOfRim ? kRim : kMaybeRim;
          const double middle = (last + 1 - 0.5 * longest) / kSectors * 2 * kPi;
          outward[i] = u * static_cast<float>(std::cos(middle)) + v * static_cast<float>(std::sin(middle));
        }
      },
      512);
  settle_small_rims(outward);
  keep_holes(outward);
}

void SurfaceCover::settle_small_rims(const std::vector<Eigen::Vector3f>& outward) {
  const auto rings_a_bare_disc = [&](std::size_t i) {
    const Element& here = elements_[i];
    const float cell = cell_of(here);
    const Eigen::Vector3f middle = here.position_mm + kDiscMiddleInCells * cell * outward[i];
    const Eigen::Vector3f u = here.normal.unitOrthogonal();
    const Eigen::Vector3f v = here.normal.cross(u);
    unsigned seen = 0;
    int in_ring = 0;
    bool bare = true;
    for_each_near(middle, kRingInCells * cell, [&](std::uint32_t j, const Eigen::Vector3f& d, float d2) {
      if (is_other_side(here.normal, elements_[j], elements_[j].position_mm - here.position_mm)) {
        return false;
      }
      const float a = u.dot(d);
      const float b = v.dot(d);
      // Above and below it as well: a wall that falls off steeply goes on there.
      bare = a * a + b * b >= kBareDiscInCells * kBareDiscInCells * cell * cell;
      if (bare && is_rim_[j] != kNoRim && -outward[j].dot(d) > kFacesMiddleCosine * std::sqrt(d2)) {
        seen |= 1U << sector_of(a, b);
        ++in_ring;
      }
      return !bare;
    });
    return bare && in_ring >= kLeastInRing && kRunOfEmpty[seen].longest <= kMostEmptySectorsOfRing;
  };
  std::vector<std::uint8_t> settled(is_rim_.size(), kNoRim);
  parallel_for_each_index(
      elements_.size(),
      [&](std::size_t i) {
        const bool rim = is_rim_[i] == kRim || (is_rim_[i] == kMaybeRim && rings_a_bare_disc(i));
        settled[i] = rim ? kRim : kNoRim;
      },
      512);
  is_rim_ = std::move(settled);
}

void SurfaceCover::keep_holes(const std::vector<Eigen::Vector3f>& outward) {
  std::vector<Rim> rims;
  std::vector<std::uint32_t> element;
  for (std::uint32_t i = 0; i < elements_.size(); ++i) {
    if (is_rim_[i] == kRim) {
      rims.push_back({elements_[i].position_mm.cast<double>(), elements_[i].normal.cast<double>(),
                      outward[i].cast<double>(), elements_[i].part,
                      kReachInCells * cells_mm_[elements_[i].level]});
      element.push_back(i);
    }
  }
  for (Hole& hole : holes_of(rims)) {
    double reach_mm = std::numeric_limits<double>::infinity();
    for (const std::uint32_t i : hole.rim) {
      reach_mm = std::min(reach_mm, rims[i].reach_mm);
    }
    if (hole.width_mm < 0.5 * reach_mm || hole.rim.size() < 3) {
      for (const std::uint32_t i : hole.rim) {
        is_rim_[element[i]] = kNoRim;
      }
      continue;
    }
    for (std::uint32_t& i : hole.rim) {
      rims_.push_back(rims[i]);
      i = static_cast<std::uint32_t>(rims_.size() - 1);
    }
    holes_.push_back(std::move(hole));
  }
}

SurfaceCover::Place SurfaceCover::at(const Eigen::Vector3d& p_mm, double radius_mm) const {
  if (elements_.empty()) {
    return Place::kBare;
  }
  Place place = Place::kBare;
  for_each_near(
      p_mm.cast<float>(), static_cast<float>(radius_mm), [&](std::uint32_t i, const Eigen::Vector3f&, float) {
        place = is_rim_[i] == kRim ? Place::kRim : place == Place::kRim ? Place::kRim : Place::kClosed;
        return place == Place::kRim;
      });
  return place;
}

std::vector<SurfaceCover::Element> SurfaceCover::within(const Eigen::Vector3d& p_mm, double radius_mm) const {
  std::vector<Element> out;
  if (!elements_.empty()) {
    for_each_near(p_mm.cast<float>(), static_cast<float>(radius_mm),
                  [&](std::uint32_t i, const Eigen::Vector3f&, float) {
                    out.push_back(elements_[i]);
                    return false;
                  });
  }
  return out;
}

}  // namespace dubsar
