// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/stitcher.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/dilated.h"
#include "core/parallel.h"
#include "triangulation/assembly.h"
#include "triangulation/patch_shape.h"
#include "triangulation/stage_passes.h"

namespace dubsar {

namespace {

/// A scan's id, and which of its stage's passes: each is stitched as if it were a scan of its own.
using PassKey = std::pair<int, int>;

struct Entry {
  StitchSurface surface;
  std::map<PassKey, Pairs> pairs;  ///< by the other pass; those without a pair hold no matches
  std::vector<std::uint8_t> wanted;
  FusedSamples fused;
  /// By node: 1 where pairs have come or gone that wanted and fused do not know of yet; empty: nowhere.
  std::vector<std::uint8_t> changed;

  void mark_changed(const Pairs& at) {
    changed.resize(at.match.size(), 0);
    for (std::size_t node = 0; node < changed.size(); ++node) {
      changed[node] |= at.match[node] >= 0 ? 1 : 0;
    }
  }
};

/// The samples that it wants and that have not been averaged yet, node by node.
std::vector<std::uint32_t> unfused(const Entry& entry) {
  using Samples = std::vector<std::uint32_t>;
  const Lattice& lattice = entry.surface.lattice;
  return parallel_reduce_ordered(
      lattice.size(), 1024, Samples{},
      [&](std::size_t begin, std::size_t end) {
        Samples found;
        for (std::size_t node = begin; node < end; ++node) {
          lattice.for_each_sample(node, [&](std::size_t i) {
            if (entry.wanted[i] != 0 && entry.fused.slot[i] == FusedSamples::kNone) {
              found.push_back(static_cast<std::uint32_t>(i));
            }
          });
        }
        return found;
      },
      [](Samples& total, const Samples& part) { total.insert(total.end(), part.begin(), part.end()); });
}

std::string name_of(const PlacedScan& scan) {
  return "scan " + std::to_string(scan.id);
}

Status check(const PlacedScan& scan) {
  if (scan.grid == nullptr) {
    return bad_input(name_of(scan), "no range grid");
  }
  const std::size_t cells = static_cast<std::size_t>(std::max(scan.grid->rows, 0)) *
                            static_cast<std::size_t>(std::max(scan.grid->cols, 0));
  if (scan.grid->size() != cells || scan.grid->valid.size() != cells) {
    return bad_input(name_of(scan), "the grid's arrays do not fit its rows and columns");
  }
  if (scan.flags != nullptr && !scan.flags->empty() && scan.flags->size() != cells) {
    return bad_input(name_of(scan), "flags and grid have different sizes", "flag the grid again");
  }
  if (!scan.model_from_scanner.is_rigid() || !scan.model_from_scanner.translation_mm.allFinite()) {
    return bad_input(name_of(scan), "its pose is not a rigid transform", "register the scan again");
  }
  return {};
}

/// Of each pass of the scan's stage.
std::vector<StitchSurface> make_surfaces(const PlacedScan& scan, const StitchSurfaceOptions& options) {
  const RangeGrid& grid = *scan.grid;
  const double spacing_mm = grid.spacing_mm > 0 ? grid.spacing_mm : estimate_spacing_mm(grid);
  const std::vector<StagePass> passes =
      spacing_mm > 0 ? stage_passes(grid, spacing_mm) : std::vector<StagePass>{};
  std::vector<StitchSurface> out;
  if (passes.empty() || passes.front().size() == static_cast<std::size_t>(grid.rows)) {
    out.push_back(make_scan_surface(scan, options));
    return out;
  }
  for (const StagePass& pass : passes) {
    RangeGrid part = grid_of_pass(grid, pass);
    part.spacing_mm = spacing_mm;
    SampleFlags flags;
    for (const int row : pass) {
      const auto first = static_cast<std::ptrdiff_t>(grid.index(row, 0));
      if (scan.flags != nullptr && !scan.flags->empty()) {
        flags.insert(flags.end(), scan.flags->begin() + first, scan.flags->begin() + first + grid.cols);
      }
    }
    PlacedScan placed = scan;
    placed.grid = &part;
    placed.flags = &flags;
    out.push_back(make_scan_surface(placed, options));
  }
  return out;
}

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
  std::map<PassKey, Entry> entries;  ///< each scan has a pass 0
  std::set<PassKey> unpaired;        ///< came since settle()

  [[nodiscard]] Status may_enter(const PlacedScan& scan) const {
    if (entries.contains({scan.id, 0})) {
      return fail(ErrorKind::kUsage, "stitched already", name_of(scan), "remove it first");
    }
    return check(scan);
  }

  /// Checks first, as far as the first bad one; then the surfaces side by side.
  Status insert(std::span<const PlacedScan> scans) {
    std::size_t sound = 0;
    Status ok;
    for (const PlacedScan& scan : scans) {
      ok = may_enter(scan);
      if (!ok) {
        break;
      }
      entries[{scan.id, 0}];
      ++sound;
    }
    std::vector<std::vector<StitchSurface>> surfaces(sound);
    parallel_for_each_index(
        sound, [&](std::size_t k) { surfaces[k] = make_surfaces(scans[k], options.surface); }, 1);
    for (std::size_t k = 0; k < sound; ++k) {
      for (std::size_t pass = 0; pass < surfaces[k].size(); ++pass) {
        const PassKey key(scans[k].id, static_cast<int>(pass));
        entries[key].surface = std::move(surfaces[k][pass]);
        unpaired.insert(key);
      }
    }
    return ok;
  }

  /// Pairs the new pass with those that its box touches.
  void pair(const PassKey& key) {
    Entry& entry = entries.at(key);
    for (auto& [other_key, other] : entries) {
      if (other_key == key || unpaired.contains(other_key)) {
        continue;
      }
      Eigen::AlignedBox3f box = other.surface.box;
      const auto margin = static_cast<float>(options.pairing.most_reach_factor *
                                             std::max(entry.surface.spacing_mm, other.surface.spacing_mm));
      if (!box.isEmpty()) {
        box.min().array() -= margin;
        box.max().array() += margin;
      }
      if (!box.intersects(entry.surface.box)) {
        continue;
      }
      const double reach = pair_reach_mm(entry.surface, other.surface, options.pairing);
      Pairs there = find_pairs(entry.surface, other.surface, reach, options.pairing);
      Pairs back = find_pairs(other.surface, entry.surface, reach, options.pairing);
      if (there.nodes == 0 && back.nodes == 0) {
        continue;
      }
      there.feather = back.feather = static_cast<float>(
          feather_samples(entry.surface, other.surface, step_mm(entry.surface, other.surface, reach)));
      other.mark_changed(back);
      entry.pairs.emplace(other_key, std::move(there));
      other.pairs.emplace(key, std::move(back));
    }
    entry.fused = FusedSamples(entry.surface);
    entry.changed.assign(entry.surface.lattice.size(), 1);
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
      const PassKey key = *unpaired.begin();
      unpaired.erase(unpaired.begin());
      pair(key);
    }
    return true;
  }

  /// All scans with their pairs; which samples they want and where these go is worked out for those whose
  /// pairs have changed. Empty when cancelled.
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
    std::size_t at = 0;
    for (auto& [key, entry] : entries) {
      if (job.cancelled()) {
        return {};
      }
      job.progress("average samples", static_cast<double>(at) / static_cast<double>(scans.size()));
      if (!entry.changed.empty()) {
        const Lattice& lattice = entry.surface.lattice;
        entry.wanted = wanted_samples(scans, at, options.ownership.least_wanted_patch_samples);
        // Samples of a node may go by the pair of one beside it.
        const std::vector<std::uint8_t> anew =
            dilated(entry.changed, lattice.node_rows, lattice.node_cols, 1);
        entry.fused.forget_if([&](std::uint32_t i) { return anew[lattice.node_of(i)] != 0; });
        scans[at].fuse(unfused(entry));
        entry.changed.clear();
      }
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
      for (auto& [key, entry] : entries) {
        entry.pairs.clear();
        StitchSurface& surface = entry.surface;
        release(entry.wanted, surface.points, surface.usable, surface.reliability_code, surface.weight_code,
                surface.rim, surface.score, surface.node_sample);
      }
    }
    const auto laid = [&] {
      for (OwnedScan& scan : scans) {
        release(scan.kept, scan.cells, scan.near_kept, scan.some_kept, scan.all_kept);
      }
      if (lets_go) {
        for (auto& [key, entry] : entries) {
          entry.fused = FusedSamples();
          release(entry.surface.normals, entry.surface.cells);
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
    const auto is_of_scan = [id](const auto& item) { return item.first.first == id; };
    if (std::erase_if(entries, is_of_scan) == 0) {
      return false;
    }
    std::erase_if(unpaired, [id](const PassKey& key) { return key.first == id; });
    for (auto& [other_key, other] : entries) {
      for (const auto& [key, pairs] : other.pairs) {
        if (key.first == id) {
          other.mark_changed(pairs);
        }
      }
      std::erase_if(other.pairs, is_of_scan);
    }
    return true;
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
  return impl_->insert(scans);
}

bool Stitcher::remove(int id) {
  return impl_->erase(id);
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
        overlap.step_mm = std::max(overlap.step_mm, step_mm(entry.surface, other, pairs.reach_mm));
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
