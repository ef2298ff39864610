// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/cleared_map.h"

#include <algorithm>
#include <map>

#include "core/grid_noise.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

/// A sphere around a scan's samples, scanner frame: scans that are apart need no look-ups.
struct Ball {
  Eigen::Vector3d center_mm{0, 0, 0};
  double radius_mm = 0;
};

Ball ball_of(const RangeGrid& grid) {
  Eigen::AlignedBox3f box;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0 && grid.point(i).allFinite()) {
      box.extend(grid.point(i));
    }
  }
  if (box.isEmpty()) {
    return {};
  }
  return {box.center().cast<double>(), 0.5 * static_cast<double>(box.diagonal().norm())};
}

SampleFlags own_marks_only(const SampleFlags& flags, std::size_t size) {
  SampleFlags out(flags);
  out.resize(size, 0);
  for (std::uint8_t& f : out) {
    f &= static_cast<std::uint8_t>(kPotentiallySparse | kSparse | kNotTablet);
  }
  return out;
}

std::vector<std::uint8_t> unflagged(const RangeGrid& grid, const SampleFlags& flags) {
  std::vector<std::uint8_t> keep(grid.size());
  for (std::size_t i = 0; i < keep.size(); ++i) {
    keep[i] = grid.valid[i] != 0 && is_unflagged(flags[i]) ? 1 : 0;
  }
  return keep;
}

}  // namespace

struct ClearedMap::Entry {
  explicit Entry(const PlacedScan& placed)
      : scan(placed),
        flags(own_marks_only(*placed.flags, placed.grid->size())),
        sparse(sparse_samples(*placed.grid, flags)),
        times_cleared(sparse.size(), 0),
        lookup(*placed.grid, unflagged(*placed.grid, flags)),
        noise_mm(estimate_noise_mm(*placed.grid)),
        ball(ball_of(*placed.grid)) {
    scan.flags = &flags;
  }

  PlacedScan scan;
  SampleFlags flags;
  std::vector<SparseSample> sparse;
  std::vector<std::uint16_t> times_cleared;           ///< by how many scans, per sparse sample
  std::map<int, std::vector<std::uint32_t>> cleared;  ///< by scan id: positions in `sparse`
  GridLookup lookup;                                  ///< of the non-flagged samples
  double noise_mm;
  Ball ball;

  void clear(int by, std::vector<std::uint32_t> which) {
    for (const std::uint32_t k : which) {
      ++times_cleared[k];
      flags[sparse[k].index] |= kCleared;
    }
    cleared[by] = std::move(which);
  }
  void restore(int by) {
    const auto it = cleared.find(by);
    if (it == cleared.end()) {
      return;
    }
    for (const std::uint32_t k : it->second) {
      if (--times_cleared[k] == 0) {
        flags[sparse[k].index] &= static_cast<std::uint8_t>(~kCleared);
      }
    }
    cleared.erase(it);
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

void ClearedMap::match(Entry& a, Entry& b) {
  const double radius_mm = matching_radius_mm(*a.scan.grid, a.noise_mm, a.scan.sigma_mm, *b.scan.grid,
                                              b.noise_mm, b.scan.sigma_mm, options_);
  const double apart_mm =
      (a.scan.model_from_scanner * a.ball.center_mm - b.scan.model_from_scanner * b.ball.center_mm).norm();
  if (!(apart_mm <= a.ball.radius_mm + b.ball.radius_mm + radius_mm)) {
    return;
  }
  const RigidTransform b_from_a = b.scan.model_from_scanner.inverse() * a.scan.model_from_scanner;
  a.clear(b.scan.id, matched_samples(a.sparse, b_from_a, b.lookup, radius_mm, options_));
  b.clear(a.scan.id, matched_samples(b.sparse, b_from_a.inverse(), a.lookup, radius_mm, options_));
}

void ClearedMap::unmatch(Entry& entry) {
  for (const std::unique_ptr<Entry>& other : entries_) {
    if (other.get() != &entry) {
      other->restore(entry.scan.id);
      entry.restore(other->scan.id);
    }
  }
}

void ClearedMap::add(const PlacedScan& scan) {
  remove(scan.id);
  auto entry = std::make_unique<Entry>(scan);
  // Each pair writes to two scans; pairs are done one after the other, their samples on all cores.
  for (const std::unique_ptr<Entry>& other : entries_) {
    match(*entry, *other);
  }
  const auto at = std::lower_bound(entries_.begin(), entries_.end(), scan.id,
                                   [](const std::unique_ptr<Entry>& e, int id) { return e->scan.id < id; });
  entries_.insert(at, std::move(entry));
}

void ClearedMap::remove(int id) {
  Entry* entry = find(id);
  if (entry == nullptr) {
    return;
  }
  unmatch(*entry);
  std::erase_if(entries_, [id](const std::unique_ptr<Entry>& e) { return e->scan.id == id; });
}

void ClearedMap::reposition(int id, const RigidTransform& model_from_scanner, double sigma_mm) {
  Entry* entry = find(id);
  if (entry == nullptr) {
    return;
  }
  unmatch(*entry);
  entry->scan.model_from_scanner = model_from_scanner;
  entry->scan.sigma_mm = sigma_mm;
  for (const std::unique_ptr<Entry>& other : entries_) {
    if (other.get() != entry) {
      match(*entry, *other);
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
  for (const auto& [other, which] : entry->cleared) {
    for (const std::uint32_t k : which) {
      int& first = by[entry->sparse[k].index];
      first = first < 0 ? other : first;
    }
  }
  return by;
}

}  // namespace dubsar
