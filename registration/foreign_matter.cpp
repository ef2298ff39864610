// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/foreign_matter.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/dilated.h"
#include "core/parallel.h"
#include "registration/foreign_witness.h"
#include "registration/grid_links.h"

namespace dubsar {

namespace {

constexpr float kLinkSpacings = 3.0F;  ///< a step to a neighbour that is longer is an edge in depth
/// Where a wall of clay beside it hides what is foreign from a look through, samples.
constexpr std::size_t kFootSamples = 6;
constexpr double kDoubtMm = 15.0;  ///< as wide as a finger
/// What hangs on something foreign, by at least so many links and so many for each one to clay, and is not so
/// many times as large, is part of it. A face that nobody else has scanned has more links to the next.
constexpr std::size_t kLeastLinks = 10;
constexpr std::size_t kLinksForEachToClay = 20;
constexpr std::size_t kMostOfForeign = 4;
/// Hands that cover each other are told apart after a few rounds, or not.
constexpr int kRounds = 3;

/// Samples of the tablet that `enter` lets in become foreign, link by link from what is.
template <class Enter>
void grow(const RangeGrid& grid, float longest_mm, std::size_t steps, std::vector<Matter>& matter,
          const Enter& enter) {
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (matter[i] == Matter::kForeign) {
      front.push_back(i);
    }
  }
  std::vector<std::size_t> next;
  for (std::size_t step = 0; step < steps && !front.empty(); ++step) {
    next.clear();
    for (const std::size_t i : front) {
      for_each_link(grid, i, longest_mm, [&](std::size_t j) {
        if (matter[j] == Matter::kTablet && enter(j)) {
          matter[j] = Matter::kForeign;
          next.push_back(j);
        }
      });
    }
    front.swap(next);
  }
}

void set_to(Matter what, const std::vector<std::size_t>& samples, std::vector<Matter>& matter) {
  for (const std::size_t i : samples) {
    matter[i] = what;
  }
}

}  // namespace

/// A witness in its place.
struct ForeignMatter::Placed {
  Witness* witness = nullptr;
  const ScanPose* pose = nullptr;
};

ForeignMatter::ForeignMatter() = default;
ForeignMatter::~ForeignMatter() = default;
ForeignMatter::ForeignMatter(ForeignMatter&&) noexcept = default;
ForeignMatter& ForeignMatter::operator=(ForeignMatter&&) noexcept = default;

void ForeignMatter::add(int id, const RangeGrid& grid, const SampleFlags& flags) {
  remove(id);
  if (grid.spacing_mm > 0 && grid.valid_count() > 0) {
    witnesses_[id] = std::make_unique<Witness>(grid, flags);
    prints_.add(id, scan_print(grid));
  }
}

void ForeignMatter::remove(int id) {
  witnesses_.erase(id);
  prints_.remove(id);
}

bool ForeignMatter::is_suspect(const Placed& own, std::span<const Placed> all) {
  return std::ranges::any_of(all, [&](const Placed& other) {
    return other.witness != own.witness &&
           own.witness->is_looked_through(*other.witness, IntoOther(*own.pose, *other.pose));
  });
}

/// Follows up what stands in the air; true when more is foreign than was.
bool ForeignMatter::look(const Placed& own, std::span<const Placed> all) {
  Witness& mine = *own.witness;
  const RangeGrid& grid = mine.grid;
  std::vector<ForeignEvidence> evidence(grid.size());
  std::vector<int> looked_through_by;
  for (const Placed& other : all) {
    if (other.witness == own.witness) {
      continue;
    }
    const std::size_t through = mine.ask(*other.witness, IntoOther(*own.pose, *other.pose),
                                         std::hypot(own.pose->sigma_mm, other.pose->sigma_mm), evidence);
    if (static_cast<double>(through) >= mine.least_in_the_air()) {
      looked_through_by.push_back(other.pose->id);
    }
  }

  const auto longest_mm = static_cast<float>(kLinkSpacings * grid.spacing_mm);
  std::vector<Matter> matter(grid.size(), Matter::kTablet);
  const auto in_the_air = [&](std::size_t i) {
    return mine.good[i] != 0 && evidence[i].through > evidence[i].shown;
  };
  const auto is_free = [&](std::size_t i) { return in_the_air(i) || evidence[i].free > evidence[i].shown; };
  for (const std::vector<std::size_t>& part : linked_parts(grid, longest_mm, in_the_air, is_free)) {
    if (static_cast<double>(std::ranges::count_if(part, in_the_air)) >= mine.least_in_the_air()) {
      set_to(Matter::kForeign, part, matter);
    }
  }
  grow(grid, longest_mm, kFootSamples, matter,
       [&](std::size_t i) { return evidence[i].front && evidence[i].shown == 0; });
  const auto foreign = static_cast<std::size_t>(std::ranges::count(matter, Matter::kForeign));

  const auto unknown = [&](std::size_t i) { return matter[i] == Matter::kTablet && evidence[i].shown == 0; };
  std::vector<std::size_t> hanging;
  for (const std::vector<std::size_t>& part : linked_parts(grid, longest_mm, unknown, unknown)) {
    std::size_t to_foreign = 0;
    std::size_t to_clay = 0;
    for (const std::size_t i : part) {
      for_each_link(grid, i, longest_mm, [&](std::size_t j) {
        to_foreign += matter[j] == Matter::kForeign ? 1 : 0;
        to_clay += evidence[j].shown > 0 ? 1 : 0;
      });
    }
    if (to_foreign >= std::max(kLeastLinks, kLinksForEachToClay * to_clay) &&
        part.size() <= kMostOfForeign * foreign) {
      hanging.insert(hanging.end(), part.begin(), part.end());
    }
  }
  set_to(Matter::kForeign, hanging, matter);

  // One word against another: where as many scans show something as looked through it.
  std::vector<std::size_t> contested;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (matter[i] == Matter::kTablet && mine.good[i] != 0 && evidence[i].through > 0) {
      contested.push_back(i);
    }
  }
  if (foreign == 0 && static_cast<double>(contested.size()) < mine.least_in_the_air()) {
    return false;
  }
  set_to(Matter::kDoubtful, contested, matter);
  // Pins are looked for and known; what remains of an arm is no reason to doubt the clay beside it.
  if (!mine.pins) {
    std::vector<std::uint8_t> is_foreign(grid.size());
    std::ranges::transform(matter, is_foreign.begin(), [](Matter what) {
      return what == Matter::kForeign ? std::uint8_t{1} : std::uint8_t{0};
    });
    const std::vector<std::uint8_t> near =
        dilated(is_foreign, grid.rows, grid.cols, static_cast<int>(std::ceil(kDoubtMm / grid.spacing_mm)));
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (near[i] != 0 && grid.valid[i] != 0 && unknown(i)) {
        matter[i] = Matter::kDoubtful;
      }
    }
  }
  const std::size_t before = mine.count(Matter::kForeign);
  mine.matter = std::move(matter);
  mine.looked_through_by = std::move(looked_through_by);
  return mine.count(Matter::kForeign) > before;
}

std::vector<ForeignFound> ForeignMatter::find(std::span<const ScanPose> poses) {
  std::vector<Placed> placed;
  std::set<int> registered;
  for (auto& [id, witness] : witnesses_) {
    witness->matter.clear();
    const auto pose = std::ranges::find(poses, id, &ScanPose::id);
    if (pose != poses.end() && pose->status == PoseStatus::kRegistered) {
      placed.push_back({witness.get(), &*pose});
      registered.insert(id);
    }
  }
  copies_ = prints_.copies_among(std::move(registered));
  std::erase_if(placed, [this](const Placed& one) { return copied_from(copies_, one.pose->id).has_value(); });
  std::vector<std::uint8_t> suspect(placed.size(), 0);
  parallel_for_each_index(
      placed.size(), [&](std::size_t k) { suspect[k] = is_suspect(placed[k], placed) ? 1 : 0; }, 1);
  bool more = true;
  for (int round = 0; round < kRounds && more; ++round) {
    more = false;
    for (std::size_t k = 0; k < placed.size(); ++k) {
      more = (suspect[k] != 0 && look(placed[k], placed)) || more;
    }
  }
  std::vector<ForeignFound> out;
  for (const auto& [witness, pose] : placed) {
    if (!witness->matter.empty()) {
      const double mm2 = witness->grid.spacing_mm * witness->grid.spacing_mm;
      std::size_t left = 0;
      for (std::size_t i = 0; i < witness->grid.size(); ++i) {
        left += witness->grid.valid[i] != 0 && witness->matter[i] == Matter::kTablet ? 1 : 0;
      }
      out.push_back({pose->id, mm2 * static_cast<double>(witness->count(Matter::kForeign)),
                     mm2 * static_cast<double>(witness->count(Matter::kDoubtful)), witness->looked_through_by,
                     mm2 * static_cast<double>(left)});
    }
  }
  return out;
}

std::vector<Matter> ForeignMatter::matter(int id, const RangeGrid& grid) const {
  const auto known = witnesses_.find(id);
  if (known == witnesses_.end() || known->second->matter.empty()) {
    return {};
  }
  const Witness& witness = *known->second;
  const int stride = witness.stride;
  // A sample between those of the witness is what the nearest of them in space is, where that is on its
  // surface.
  std::vector<Matter> out(grid.size(), Matter::kTablet);
  parallel_for_each_index(grid.size(), [&](std::size_t i) {
    if (grid.valid[i] == 0) {
      return;
    }
    float nearest_mm = kLinkSpacings * static_cast<float>(witness.grid.spacing_mm);
    for (int k = 0; k < 4; ++k) {
      const int row = grid.row_of(i) / stride + k / 2;
      const int col = grid.col_of(i) / stride + k % 2;
      if (witness.grid.is_valid(row, col)) {
        const std::size_t j = witness.grid.index(row, col);
        const float apart_mm = (witness.grid.point(j) - grid.point(i)).norm();
        out[i] = apart_mm < nearest_mm ? witness.matter[j] : out[i];
        nearest_mm = std::min(nearest_mm, apart_mm);
      }
    }
  });
  return out;
}

}  // namespace dubsar
