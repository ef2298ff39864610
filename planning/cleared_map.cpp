// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/cleared_map.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/parallel.h"

namespace dubsar {

namespace {

SampleFlags own_marks_only(const SampleFlags& flags, std::size_t size) {
  SampleFlags out(flags);
  out.resize(size, 0);
  for (std::uint8_t& f : out) {
    f &= static_cast<std::uint8_t>(kPotentiallySparse | kSparse | kNotTablet);
  }
  return out;
}

}  // namespace

struct ClearedMap::Entry {
  explicit Entry(const PlacedScan& placed)
      : scan(placed),
        flags(own_marks_only(*placed.flags, placed.grid->size())),
        sparse(sparse_samples(*placed.grid, flags)),
        times_cleared(sparse.samples.size(), 0),
        lookup(*placed.grid, unflagged_samples(*placed.grid, flags)),
        normals(normals_of(*placed.grid)),
        box_mm(lookup.box_mm()) {
    box_mm.extend(sparse.box_mm);
    scan.flags = &flags;
    scan.noise_mm = noise_of(placed);
  }

  PlacedScan scan;
  SampleFlags flags;
  SparseSamples sparse;
  std::vector<std::uint16_t> times_cleared;  ///< by how many scans, per sparse sample
  GridLookup lookup;                         ///< of the non-flagged samples
  SampleNormals normals;
  Eigen::AlignedBox3f box_mm;  ///< of what clears and what may be cleared, scanner frame

  /// What one other scan clears of this one, and how they lay to each other when that was found out.
  struct Match {
    std::vector<std::uint32_t> which;  ///< positions in `sparse`
    RigidTransform other_from_own;
    double radius_mm = 0;
  };
  std::map<int, Match> matches;  ///< by the other's id

  void clear(int by, Match match) {
    restore(by);
    for (const std::uint32_t k : match.which) {
      ++times_cleared[k];
      flags[sparse.samples[k].index] |= kCleared;
    }
    matches[by] = std::move(match);
  }
  void restore(int by) {
    const auto it = matches.find(by);
    if (it == matches.end()) {
      return;
    }
    for (const std::uint32_t k : it->second.which) {
      if (--times_cleared[k] == 0) {
        flags[sparse.samples[k].index] &= static_cast<std::uint8_t>(~kCleared);
      }
    }
    matches.erase(it);
  }
  [[nodiscard]] Eigen::Vector3d center_mm() const { return box_mm.center().cast<double>(); }
  [[nodiscard]] double radius_mm() const { return 0.5 * static_cast<double>(box_mm.diagonal().norm()); }
  /// Whether a match that was made in this way would come out the same, to within that much.
  [[nodiscard]] bool still_holds(const Match& match, const RigidTransform& other_from_own, double radius,
                                 double most_mm) const {
    return std::abs(match.radius_mm - radius) <= most_mm &&
           displacement_mm(box_mm, match.other_from_own, other_from_own) <= most_mm;
  }
};

ClearedMap::ClearedMap(ClearingOptions options) : options_(options) {}
ClearedMap::~ClearedMap() = default;
ClearedMap::ClearedMap(ClearedMap&&) noexcept = default;
ClearedMap& ClearedMap::operator=(ClearedMap&&) noexcept = default;

ClearedMap::Entry* ClearedMap::find(int id) const {
  const auto it = std::find_if(entries_.begin(), entries_.end(),
                               [id](const std::unique_ptr<Entry>& e) { return e->scan.id == id; });
  return it == entries_.end() ? nullptr : it->get();
}

/// Matches a pair both ways, unless it was and its scans have hardly moved against each other since
/// (tolerance in µ).
void ClearedMap::match(Entry& one, Entry& two, double tolerance) {
  // Whichever came first: the same arithmetic.
  Entry& a = one.scan.id < two.scan.id ? one : two;
  Entry& b = one.scan.id < two.scan.id ? two : one;
  const double radius_mm = matching_radius_mm(*a.scan.grid, *a.scan.noise_mm, a.scan.sigma_mm, *b.scan.grid,
                                              *b.scan.noise_mm, b.scan.sigma_mm, options_);
  const RigidTransform b_from_a = b.scan.model_from_scanner.inverse() * a.scan.model_from_scanner;
  const auto before = a.matches.find(b.scan.id);
  const double most_mm = tolerance * std::min(spacing_of(*a.scan.grid), spacing_of(*b.scan.grid));
  if (before != a.matches.end() && a.still_holds(before->second, b_from_a, radius_mm, most_mm)) {
    return;
  }
  const bool empty = a.box_mm.isEmpty() || b.box_mm.isEmpty();
  const double apart_mm = empty ? 0 : (b_from_a * a.center_mm() - b.center_mm()).norm();
  Entry::Match of_a{{}, b_from_a, radius_mm};
  Entry::Match of_b{{}, b_from_a.inverse(), radius_mm};
  // Scans that are apart need no look-ups.
  if (!empty && apart_mm <= a.radius_mm() + b.radius_mm() + radius_mm) {
    of_a.which = matched_samples(a.sparse, b_from_a, b.lookup, b.normals, radius_mm, options_);
    of_b.which = matched_samples(b.sparse, of_b.other_from_own, a.lookup, a.normals, radius_mm, options_);
  }
  a.clear(b.scan.id, std::move(of_a));
  b.clear(a.scan.id, std::move(of_b));
}

void ClearedMap::add(const PlacedScan& scan) {
  remove(scan.id);
  auto entry = std::make_unique<Entry>(scan);
  // Each pair writes to two scans; pairs are done one after the other, their samples on all cores.
  for (const std::unique_ptr<Entry>& other : entries_) {
    match(*entry, *other, 0);
  }
  const auto at = std::lower_bound(entries_.begin(), entries_.end(), scan.id,
                                   [](const std::unique_ptr<Entry>& e, int id) { return e->scan.id < id; });
  entries_.insert(at, std::move(entry));
}

void ClearedMap::remove(int id) {
  if (find(id) == nullptr) {
    return;
  }
  std::erase_if(entries_, [id](const std::unique_ptr<Entry>& e) { return e->scan.id == id; });
  for (const std::unique_ptr<Entry>& other : entries_) {
    other->restore(id);
  }
}

void ClearedMap::reposition(int id, const RigidTransform& model_from_scanner, double sigma_mm) {
  const NewPose pose{id, model_from_scanner, sigma_mm};
  reposition({&pose, 1}, 0);
}

void ClearedMap::reposition(std::span<const NewPose> poses, double tolerance) {
  std::vector<std::uint8_t> moved(entries_.size(), 0);
  for (const NewPose& pose : poses) {
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      if (entries_[k]->scan.id == pose.id) {
        entries_[k]->scan.model_from_scanner = pose.model_from_scanner;
        entries_[k]->scan.sigma_mm = pose.sigma_mm;
        moved[k] = 1;
      }
    }
  }
  for (std::size_t a = 0; a < entries_.size(); ++a) {
    for (std::size_t b = a + 1; b < entries_.size(); ++b) {
      if (moved[a] != 0 || moved[b] != 0) {
        match(*entries_[a], *entries_[b], tolerance);
      }
    }
  }
}

bool ClearedMap::contains(int id) const {
  return find(id) != nullptr;
}

const SampleFlags* ClearedMap::flags(int id) const {
  const Entry* entry = find(id);
  return entry == nullptr ? nullptr : &entry->flags;
}

Eigen::AlignedBox3f ClearedMap::box_mm(int id) const {
  const Entry* entry = find(id);
  return entry == nullptr ? Eigen::AlignedBox3f{} : entry->box_mm;
}

std::vector<PlacedScan> ClearedMap::scans() const {
  std::vector<PlacedScan> out;
  out.reserve(entries_.size());
  for (const std::unique_ptr<Entry>& entry : entries_) {
    out.push_back(entry->scan);
  }
  return out;
}

std::vector<int> ClearedMap::cleared_by(int id) const {
  const Entry* entry = find(id);
  if (entry == nullptr) {
    return {};
  }
  std::vector<int> by(entry->flags.size(), -1);
  for (const auto& [other, match] : entry->matches) {
    for (const std::uint32_t k : match.which) {
      int& first = by[entry->sparse.samples[k].index];
      first = first < 0 ? other : first;
    }
  }
  return by;
}

}  // namespace dubsar
