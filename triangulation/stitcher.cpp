// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/stitcher.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/dilated.h"
#include "core/parallel.h"
#include "triangulation/assembly.h"
#include "triangulation/patch_shape.h"
#include "triangulation/primary_votes.h"
#include "triangulation/scan_surfaces.h"
#include "triangulation/stitch_entry.h"

namespace dubsar {

namespace {

/// Gives memory back, as clear() and `= {}` do not.
template <class... T>
void release(std::vector<T>&... arrays) {
  ((arrays = std::vector<T>()), ...);
}

std::unexpected<Error> cancelled() {
  return fail(ErrorKind::kCancelled, "stitching was stopped");
}

}  // namespace

struct Stitcher::Impl {
  StitchOptions options;
  std::map<int, Held> held;          ///< all scans
  KnownPrints prints;                ///< of these
  std::map<PassKey, Entry> entries;  ///< of those that take part: each has a pass 0
  std::set<PassKey> unpaired;        ///< came since settle()
  bool places_are_old = false;       ///< pairs have come or gone since weigh_places()

  /// `before`: what comes with it.
  [[nodiscard]] Status may_enter(const PlacedScan& scan, const std::set<int>& before) const {
    if (held.contains(scan.id) || before.contains(scan.id)) {
      return fail(ErrorKind::kUsage, "stitched already", stitched_name(scan), "remove it first");
    }
    return check_stitchable(scan);
  }

  /// Checks first, as far as the first bad one; then the surfaces, several side by side. Nothing is held
  /// before all are ready.
  Status insert(std::span<const PlacedScan> scans, const JobContext& job) {
    constexpr std::size_t kSideBySide = 16;
    std::set<int> ids;
    Status ok;
    for (const PlacedScan& scan : scans) {
      ok = may_enter(scan, ids);
      if (!ok) {
        break;
      }
      ids.insert(scan.id);
    }
    struct Ready {
      std::optional<ScanPrint> print;
      std::vector<StitchSurface> passes;
    };
    std::vector<Ready> ready(ids.size());
    for (std::size_t first = 0; first < ready.size(); first += kSideBySide) {
      if (first > 0) {
        job.progress("triangulate grids", static_cast<double>(first) / static_cast<double>(ready.size()));
      }
      parallel_for_each_index(
          std::min(kSideBySide, ready.size() - first),
          [&](std::size_t k) {
            if (const PlacedScan& scan = scans[first + k]; !job.cancelled()) {
              ready[first + k] = {scan_print(*scan.grid), surfaces_of_passes(scan, options.surface, job)};
            }
          },
          1);
      if (job.cancelled()) {
        return cancelled();
      }
    }
    for (std::size_t k = 0; k < ready.size(); ++k) {
      prints.add(scans[k].id, std::move(ready[k].print));
      held[scans[k].id].waiting = std::move(ready[k].passes);
    }
    leave_out_copies();
    return ok;
  }

  /// Of scans that are one measurement one takes part, the others wait.
  void leave_out_copies() {
    const std::vector<ScanCopy> copies = prints.copies();
    for (const auto& [id, scan] : held) {
      if (const bool is_copy = copied_from(copies, id).has_value(); is_copy != scan.waits()) {
        is_copy ? step_out(id) : enter(id);
      }
    }
  }

  /// Puts in a scan that waits.
  void enter(int id) {
    std::vector<StitchSurface> passes = std::exchange(held.at(id).waiting, {});
    for (std::size_t pass = 0; pass < passes.size(); ++pass) {
      const PassKey key(id, static_cast<int>(pass));
      entries[key].surface = std::move(passes[pass]);
      unpaired.insert(key);
    }
  }

  /// A scan that takes part waits from now on.
  void step_out(int id) {
    std::vector<StitchSurface>& waiting = held.at(id).waiting;
    for (auto entry = entries.lower_bound({id, 0}); entry != entries.end() && entry->first.first == id;
         ++entry) {
      waiting.push_back(std::move(entry->second.surface));
    }
    erase_entries(id);
  }

  /// Pairs the new pass with those that its box touches, several side by side: much of what is done for one
  /// of them, above all the fit of the step between both, is work for a single thread. False when cancelled:
  /// then nothing has changed.
  bool pair(const PassKey& key, const JobContext& job) {
    Entry& entry = entries.at(key);
    std::vector<std::pair<PassKey, const StitchSurface*>> others;
    for (const auto& [other_key, other] : entries) {
      if (other_key != key && !unpaired.contains(other_key)) {
        others.emplace_back(other_key, &other.surface);
      }
    }
    std::vector<std::optional<FoundPairs>> all(others.size());
    parallel_for_each_index(
        others.size(),
        [&](std::size_t k) {
          if (const auto& [other_key, other] = others[k]; !job.cancelled()) {
            all[k] = pairs_between(key, entry.surface, other_key, *other, options.pairing, job);
          }
        },
        1);
    if (job.cancelled()) {
      return false;
    }
    for (std::optional<FoundPairs>& found : all) {
      if (!found) {
        continue;
      }
      FoundPairs& pairs = *found;
      Entry& other = entries.at(pairs.other);
      other.mark_changed(pairs.back);
      if (pairs.other.first != key.first) {  // passes of one scan are held by each other, not by a pose
        (key < pairs.other ? entry.steps[pairs.other] : other.steps[key]) = pairs.step;
      }
      entry.pairs.emplace(pairs.other, std::move(pairs.there));
      other.pairs.emplace(key, std::move(pairs.back));
    }
    entry.fused = FusedSamples(entry.surface);
    entry.mark_all_changed();
    places_are_old = true;
    return true;
  }

  /// Brings pairs and averages up to date: a scan that comes and goes again costs nothing but its surface.
  bool settle(const JobContext& job) {
    const double count = std::max(1.0, static_cast<double>(unpaired.size()));
    double done = 0;
    while (!unpaired.empty()) {
      if (job.cancelled()) {
        return false;
      }
      job.progress("pair samples", done++ / count);
      if (!pair(*unpaired.begin(), job)) {
        return false;
      }
      unpaired.erase(unpaired.begin());
    }
    if (places_are_old && !weigh_places(entries, job)) {
      return false;
    }
    places_are_old = false;
    return true;
  }

  /// Which samples scans want, by the votes of each: whom one leaves a place to may change with scans that it
  /// has no pair in. Of a scan whose votes are as they were the samples are, too.
  void want(std::vector<std::vector<float>> votes) {
    std::vector<Entry*> anew;
    auto of_entry = votes.begin();
    for (auto& [key, entry] : entries) {
      if (entry.votes != *of_entry) {
        entry.votes = std::move(*of_entry);
        anew.push_back(&entry);
      }
      ++of_entry;
    }
    // Side by side: much of it is work for a single thread.
    parallel_for_each_index(
        anew.size(),
        [&](std::size_t k) {
          anew[k]->wanted =
              wanted_samples(anew[k]->surface, anew[k]->votes, options.ownership.least_wanted_patch_samples);
        },
        1);
  }

  /// All scans with their pairs and which samples they want; where these go is worked out for those that are
  /// new or whose pairs have changed. Empty when cancelled.
  [[nodiscard]] std::vector<OwnedScan> owned_scans(const JobContext& job) {
    std::vector<OwnedScan> scans;
    std::map<PassKey, std::size_t> position;
    for (const auto& [key, entry] : entries) {
      position[key] = position.size();
    }
    for (auto& [key, entry] : entries) {
      OwnedScan& scan = scans.emplace_back();
      scan.surface = &entry.surface;
      scan.fused = &entry.fused;
      scan.wanted = &entry.wanted;
      for (const auto& [other_key, pairs] : entry.pairs) {
        scan.pairs.push_back(&pairs);
        scan.other.push_back(position.at(other_key));
        scan.other_surface.push_back(&entries.at(other_key).surface);
      }
    }
    std::vector<std::vector<float>> votes = primary_votes(scans, job);
    if (votes.size() != scans.size()) {
      return {};
    }
    want(std::move(votes));
    std::size_t at = 0;
    for (auto& [key, entry] : entries) {
      if (job.cancelled()) {
        return {};
      }
      job.progress("average samples", static_cast<double>(at) / static_cast<double>(scans.size()));
      if (!entry.changed.empty()) {
        const Lattice& lattice = entry.surface.lattice;
        // Samples of a node may go by the pair of one beside it.
        const std::vector<std::uint8_t> anew =
            dilated(entry.changed, lattice.node_rows, lattice.node_cols, 1);
        entry.fused.forget_if([&](std::uint32_t i) { return anew[lattice.node_of(i)] != 0; });
      }
      scans[at].fuse(unfused(entry), job);
      if (job.cancelled()) {
        return {};
      }
      entry.changed.clear();
      // What an earlier mesh needed besides must not show in the next.
      entry.fused.forget_if([&](std::uint32_t i) { return entry.wanted[i] == 0; });
      ++at;
    }
    return scans;
  }

  [[nodiscard]] Result<Mesh> mesh(bool lets_go, const JobContext& job) {
    if (!settle(job)) {
      return cancelled();
    }
    std::vector<OwnedScan> scans = owned_scans(job);
    if (job.cancelled() || !assign_owners(scans, options.surface.grid, options.ownership, job)) {
      return cancelled();
    }
    if (lets_go) {  // of what patches are not laid from
      held.clear();
      prints.clear();
      for (auto& [key, entry] : entries) {
        entry.pairs.clear();
        StitchSurface& surface = entry.surface;
        release(entry.votes, entry.wanted, surface.points, surface.usable, surface.reliability_code,
                surface.weight_code, surface.rim, surface.score, surface.node_sample);
      }
    }
    const auto laid = [&] {
      for (OwnedScan& scan : scans) {
        release(scan.kept, scan.cells, scan.loose, scan.near_kept, scan.some_kept, scan.all_kept);
      }
      if (lets_go) {
        for (auto& [key, entry] : entries) {
          entry.fused = FusedSamples();
          release(entry.surface.normals, entry.surface.cells, entry.surface.colours);
        }
      }
    };
    Mesh mesh = assemble(scans, {options.seam, options.gap, options.least_component_faces}, laid, job);
    if (job.cancelled()) {
      return cancelled();
    }
    return mesh;
  }

  bool erase(int id) {
    const auto found = held.find(id);
    if (found == held.end()) {
      return false;
    }
    const bool took_part = !found->second.waits();
    held.erase(found);
    prints.remove(id);
    if (took_part) {
      erase_entries(id);
    }
    leave_out_copies();
    return true;
  }

  void erase_entries(int id) {
    const auto is_of_scan = [id](const auto& item) { return item.first.first == id; };
    std::erase_if(entries, is_of_scan);
    places_are_old = true;
    std::erase_if(unpaired, [id](const PassKey& key) { return key.first == id; });
    for (auto& [other_key, other] : entries) {
      for (const auto& [key, pairs] : other.pairs) {
        if (key.first == id) {
          other.mark_changed(pairs);
        }
      }
      std::erase_if(other.pairs, is_of_scan);
      std::erase_if(other.steps, is_of_scan);
    }
  }
};

Stitcher::Stitcher(StitchOptions options) : impl_(std::make_unique<Impl>()) {
  impl_->options = std::move(options);
}
Stitcher::~Stitcher() = default;
Stitcher::Stitcher(Stitcher&&) noexcept = default;
Stitcher& Stitcher::operator=(Stitcher&&) noexcept = default;

Status Stitcher::add(const PlacedScan& scan, const JobContext& job) {
  return add({&scan, 1}, job);
}

Status Stitcher::add(std::span<const PlacedScan> scans, const JobContext& job) {
  if (job.cancelled()) {
    return cancelled();
  }
  return impl_->insert(scans, job);
}

bool Stitcher::remove(int id) {
  return impl_->erase(id);
}

std::vector<ScanCopy> Stitcher::copies() const {
  return impl_->prints.copies();
}

std::vector<int> Stitcher::without_surface() const {
  return dubsar::without_surface(impl_->entries);
}

std::vector<Stitcher::Overlap> Stitcher::overlaps() const {
  std::map<std::pair<int, int>, Overlap> found;  // of all passes of two scans together
  impl_->settle(JobContext{});
  for (const auto& [key, entry] : impl_->entries) {
    for (const auto& [other_key, pairs] : entry.pairs) {
      if (const int id = key.first, other_id = other_key.first; id < other_id) {
        const StitchSurface& other = impl_->entries.at(other_key).surface;
        Overlap& overlap = found[{id, other_id}];
        overlap.id = id;
        overlap.other_id = other_id;
        overlap.nodes += pairs.nodes;
        overlap.step_mm = std::max(overlap.step_mm, entry.steps.at(other_key).step_mm());
        overlap.spacing_mm = std::max(entry.surface.spacing_mm, other.spacing_mm);
      }
    }
  }
  std::vector<Overlap> out;
  for (const auto& [ids, overlap] : found) {
    out.push_back(overlap);
  }
  return out;
}

std::map<int, double> Stitcher::moved_mm() const {
  impl_->settle(JobContext{});
  return dubsar::moved_mm(impl_->entries);
}

Status Stitcher::update(const JobContext& job) {
  if (!impl_->settle(job)) {
    return cancelled();
  }
  const std::size_t held = impl_->owned_scans(job).size();
  return held == impl_->entries.size() ? Status{} : cancelled();
}

Result<Mesh> Stitcher::mesh(const JobContext& job) const {
  return impl_->mesh(false, job);
}

Result<Mesh> Stitcher::take_mesh(const JobContext& job) {
  Result<Mesh> mesh = impl_->mesh(true, job);
  impl_->held.clear();
  impl_->prints.clear();
  impl_->entries.clear();
  impl_->unpaired.clear();
  return mesh;
}

Mesh Stitcher::mesh() const {
  const JobContext job;
  return mesh(job).value_or(Mesh{});
}

Result<Mesh> stitch(std::span<const PlacedScan> scans, const StitchOptions& options, const JobContext& job) {
  Stitcher stitcher(options);
  job.progress("triangulate grids", 0.0);
  if (const Status ok = stitcher.add(scans, job); !ok) {
    return std::unexpected(ok.error());
  }
  return stitcher.take_mesh(job);
}

}  // namespace dubsar
