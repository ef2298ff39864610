// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/wedge_ids.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <set>
#include <tuple>
#include <utility>

#include "analysis/text_frame.h"
#include "core/near_cells.h"

namespace dubsar {

namespace {

/// Of fewer wedges, places that differ do not tell that they are another tablet's.
constexpr std::size_t kFewest = 5;

/// As a tablet is turned: over its lower edge to the reverse. By Face.
constexpr std::array<int, kFaceCount> kSideInOrder = {0, 2, 4, 5, 3, 1};

/// The wedges of these numbers, in the order in which they are read among all.
void sort_as_read(const Mesh& mesh, std::vector<Wedge> all, std::vector<std::size_t>* numbers) {
  place_wedges(find_text_frame(mesh, all), &all);
  std::ranges::stable_sort(*numbers, {}, [&](std::size_t i) {
    const WedgePlace& place = all[i].place;
    return std::tuple(place.body, kSideInOrder[static_cast<std::size_t>(*place.side)], place.line,
                      place.order);
  });
}

}  // namespace

WedgeIds::WedgeIds(const EarlierWedges& earlier) : may_be_others_(earlier.may_be_others) {
  std::set<int> ids;
  for (const KnownWedge& one : earlier.wedges) {
    if (one.id >= 0 && one.id <= kMostId && ids.insert(one.id).second) {
      known_.push_back(one);
      next_ = std::max(next_, one.id + 1);
    }
  }
  std::ranges::sort(known_, {}, &KnownWedge::id);
  is_now_.assign(known_.size(), 0);
  earlier_ = known_;
}

/// Sets the ids of those that lie where an earlier one lay. What a better mesh shows by itself may have been
/// added by hand before.
void WedgeIds::know_again(const std::vector<Wedge>& found, std::vector<int>* ids) {
  NearCells places(kSamePlaceMm);
  for (std::size_t f = 0; f < found.size(); ++f) {
    places.add(found[f].depth_point_mm, f);
  }
  struct Pair {
    bool was_added;
    double off_mm;
    std::size_t known;
    std::size_t found;
  };
  std::vector<Pair> pairs;
  std::size_t measured = 0;
  for (std::size_t k = 0; k < known_.size(); ++k) {
    const bool was_added = known_[k].by_hand == ByHand::kAdded;
    measured += known_[k].by_hand == ByHand::kNo ? 1 : 0;
    if (known_[k].by_hand != ByHand::kNo && !was_added) {
      continue;
    }
    for (const std::size_t f : places.about(known_[k].depth_point_mm)) {
      const double off_mm = (found[f].depth_point_mm - known_[k].depth_point_mm).norm();
      if (off_mm <= kSamePlaceMm) {
        pairs.push_back({was_added, off_mm, k, f});
      }
    }
  }
  std::ranges::sort(pairs, {},
                    [](const Pair& p) { return std::tuple(p.was_added, p.off_mm, p.known, p.found); });
  std::vector<Pair> same;
  std::vector<std::uint8_t> is_taken(known_.size(), 0);
  std::vector<std::uint8_t> has_id(found.size(), 0);
  for (const Pair& p : pairs) {
    if (is_taken[p.known] == 0 && has_id[p.found] == 0) {
      is_taken[p.known] = 1;
      has_id[p.found] = 1;
      same.push_back(p);
    }
  }
  const std::size_t most = std::min(measured, found.size());
  if (may_be_others_ && most >= kFewest && 2 * same.size() < most) {
    known_.clear();
    earlier_.clear();
    is_now_.clear();
    next_ = 0;
    forgot_earlier_ = true;
    return;
  }
  found_again_ = same.size();
  for (const Pair& p : same) {
    (*ids)[p.found] = known_[p.known].id;
    give(p.known, found[p.found]);
  }
}

std::vector<int> WedgeIds::of_found(const Mesh& mesh, const std::vector<Wedge>& found) {
  std::vector<int> ids(found.size(), -1);
  know_again(found, &ids);
  std::vector<std::size_t> others;
  for (std::size_t f = 0; f < found.size(); ++f) {
    if (ids[f] < 0) {
      others.push_back(f);
    }
  }
  if (!others.empty()) {
    sort_as_read(mesh, found, &others);
  }
  for (const std::size_t f : others) {
    ids[f] = give_new(found[f]);
  }
  return ids;
}

int WedgeIds::of_made(const Wedge& made) {
  std::size_t same = known_.size();
  std::pair best(true, kSamePlaceMm);
  for (std::size_t k = 0; k < known_.size(); ++k) {
    const bool came_otherwise = known_[k].by_hand != made.by_hand;
    const bool was_measured = made.by_hand == ByHand::kAdded && known_[k].by_hand == ByHand::kNo;
    if (is_now_[k] != 0 || (came_otherwise && !was_measured)) {
      continue;
    }
    const std::pair at(came_otherwise, (known_[k].depth_point_mm - made.depth_point_mm).norm());
    if (at.second <= kSamePlaceMm && at < best) {
      best = at;
      same = k;
    }
  }
  if (same == known_.size()) {
    return give_new(made);
  }
  ++found_again_;
  give(same, made);
  return known_[same].id;
}

bool WedgeIds::is_of_one_gone(const Eigen::Vector3d& place_mm, int id) const {
  const auto own = std::ranges::find(earlier_, id, &KnownWedge::id);
  if (own == earlier_.end()) {
    return false;  // where it lay nobody knows
  }
  const auto off_mm = [&](const KnownWedge& one) { return (one.depth_point_mm - place_mm).norm(); };
  const double own_off_mm = off_mm(*own);
  for (std::size_t k = 0; k < earlier_.size(); ++k) {
    // What a person made comes later than what is said of those that were measured.
    if (is_now_[k] == 0 && earlier_[k].by_hand == ByHand::kNo && off_mm(earlier_[k]) <= kSamePlaceMm &&
        off_mm(earlier_[k]) < own_off_mm) {
      return true;
    }
  }
  return false;
}

std::vector<KnownWedge> WedgeIds::former(const std::vector<Wedge>& left) const {
  std::set<int> there;
  for (const Wedge& wedge : left) {
    there.insert(wedge.id);
  }
  std::vector<KnownWedge> out;
  std::ranges::copy_if(known_, std::back_inserter(out),
                       [&](const KnownWedge& one) { return !there.contains(one.id); });
  std::ranges::sort(out, {}, &KnownWedge::id);
  return out;
}

void WedgeIds::give(std::size_t known, const Wedge& wedge) {
  known_[known].depth_point_mm = wedge.depth_point_mm;
  known_[known].by_hand = wedge.by_hand;
  is_now_[known] = 1;
}

int WedgeIds::give_new(const Wedge& wedge) {
  known_.push_back({next_, wedge.depth_point_mm, wedge.by_hand});
  is_now_.push_back(1);
  return next_++;
}

}  // namespace dubsar
