// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/ownership.h"

#include <algorithm>
#include <iterator>

#include "core/parallel.h"
#include "triangulation/contest.h"
#include "triangulation/patch_shape.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

constexpr std::uint8_t kBoth = kCellFirst | kCellSecond;
constexpr std::size_t kContestGrain = 64;  ///< nodes: where there is a contest, each is much work

/// Room for the averaged samples of one scan after another [rows*cols]. Only those of cells at stake are
/// laid; what an earlier scan left elsewhere is not looked at.
struct LaidSamples {
  std::vector<Vector3f> points, normals;
  std::vector<std::uint8_t> at_stake;  ///< 1 for the cells that have a new corner

  void lay(const OwnedScan& scan, std::span<const std::uint8_t> kept, std::span<const std::uint8_t> fresh);
};

void LaidSamples::lay(const OwnedScan& scan, std::span<const std::uint8_t> kept,
                      std::span<const std::uint8_t> fresh) {
  const std::size_t count = fresh.size();
  const auto width = static_cast<std::size_t>(scan.surface->lattice.cols);
  points.resize(std::max(points.size(), count));
  normals.resize(std::max(normals.size(), count));
  at_stake.resize(count);
  parallel_for_each_index(
      count,
      [&](std::size_t i) {
        at_stake[i] =
            i + width + 1 < count ? fresh[i] | fresh[i + 1] | fresh[i + width] | fresh[i + width + 1] : 0;
      },
      16384);
  parallel_for_each_index(
      count,
      [&](std::size_t i) {
        const bool is_corner =
            (at_stake[i] | (i >= 1 ? at_stake[i - 1] : 0) | (i >= width ? at_stake[i - width] : 0) |
             (i > width ? at_stake[i - width - 1] : 0)) != 0;
        if (is_corner && kept[i] != 0) {
          points[i] = scan.fused->point(i);
          normals[i] = scan.surface->normal(i);
        }
      },
      16384);
}

/// Gives a scan the samples `fresh` besides those that it keeps: triangles between them that meet no other
/// patch; then the samples they use.
void add_samples(std::vector<OwnedScan>& scans, std::size_t self, std::vector<std::uint8_t> fresh,
                 const Contest& contest, const GridTriangulationOptions& grid,
                 const OwnershipOptions& options, int least_patch, LaidSamples& laid, const JobContext& job) {
  OwnedScan& scan = scans[self];
  const Lattice& lattice = scan.surface->lattice;
  GridSurface g = scan.surface->surface();
  std::vector<std::uint8_t> kept = std::move(scan.kept);
  std::vector<std::uint8_t> cells = std::move(scan.cells);
  kept.resize(fresh.size(), 0);
  cells.resize(fresh.size(), 0);
  parallel_for_each_index(
      fresh.size(), [&](std::size_t i) { kept[i] |= fresh[i]; }, 65536);
  laid.lay(scan, kept, fresh);
  g.points = laid.points;
  g.normals = laid.normals;
  triangulate_cells_anew(g, kept, scan.surface->mirrored, grid, laid.at_stake, cells);
  parallel_chunks(contest.any.size(), kContestGrain, [&](std::size_t begin, std::size_t end) {
    NodeContest here(scans, self, contest, options);
    for (std::size_t node = begin; node < end && !job.cancelled(); ++node) {
      if (contest.any[node] == 0) {
        continue;
      }
      here.enter(node);
      lattice.for_each_sample(node, [&](std::size_t i) {
        if (laid.at_stake[i] == 0) {
          return;
        }
        std::uint8_t& cell = cells[i];
        const int row = lattice.sample_row(i);
        const int col = lattice.sample_col(i);
        for (int which = 0; (cell & kBoth) != 0 && which < 2; ++which) {
          const std::uint8_t bit = which == 0 ? kCellFirst : kCellSecond;
          if ((cell & bit) != 0 && here.meets_another(g.points, cell_triangle(g, row, col, cell, which))) {
            cell = static_cast<std::uint8_t>(cell & ~bit);
          }
        }
      });
    }
  });
  remove_specks(kept, cells, fresh, lattice, least_patch);
  scan.kept = std::move(kept);
  scan.cells = std::move(cells);
  settle_patches(scan);
}

/// Samples that nobody keeps, nor lies over.
std::vector<std::uint32_t> uncovered_samples(const std::vector<OwnedScan>& scans, std::size_t self,
                                             const Contest& contest, const OwnershipOptions& options,
                                             const JobContext& job) {
  const OwnedScan& scan = scans[self];
  const Lattice& lattice = scan.surface->lattice;
  using Samples = std::vector<std::uint32_t>;
  Samples out = parallel_reduce_ordered(
      lattice.size(), 256, Samples{},
      [&](std::size_t begin, std::size_t end) {
        Samples found;
        NodeContest here(scans, self, contest, options);
        for (std::size_t node = begin; node < end && !job.cancelled(); ++node) {
          if (scan.surface->node_sample[node] < 0 || scan.all_kept[node] != 0) {
            continue;
          }
          bool covered = false;
          for (std::size_t k = 0; k < scan.pairs.size() && !covered; ++k) {
            const OwnedScan& other = scans[scan.other[k]];
            const Lattice& theirs = other.surface->lattice;
            const std::int32_t j = scan.pairs[k]->match[node];
            covered = j >= 0 && !theirs.any_within(theirs.node_of(static_cast<std::size_t>(j)),
                                                   reach_nodes(*scan.surface, *other.surface),
                                                   [&](std::size_t n) { return other.all_kept[n] == 0; });
          }
          if (covered) {
            continue;
          }
          here.enter(node);
          lattice.for_each_sample(node, [&](std::size_t i) {
            if (scan.surface->usable[i] != 0 && scan.kept[i] == 0 && !here.is_taken(i)) {
              found.push_back(static_cast<std::uint32_t>(i));
            }
          });
        }
        return found;
      },
      [](Samples& total, const Samples& part) { total.insert(total.end(), part.begin(), part.end()); });
  return out;
}

}  // namespace

bool assign_owners(std::vector<OwnedScan>& scans, const GridTriangulationOptions& grid,
                   const OwnershipOptions& options, const JobContext& job) {
  for (OwnedScan& scan : scans) {
    scan.kept.clear();
    scan.cells.clear();
    scan.loose.clear();
    scan.near_kept.clear();
    scan.some_kept.clear();
    scan.all_kept.clear();
  }
  LaidSamples laid;
  const double steps = 2.0 * static_cast<double>(scans.size());
  for (std::size_t self = 0; self < scans.size(); ++self) {
    if (job.cancelled()) {
      return false;
    }
    job.progress("assign primary scans", static_cast<double>(self) / steps);
    const Contest contest = contest_of(scans, self);
    std::vector<std::uint8_t> fresh = *scans[self].wanted;
    parallel_chunks(contest.any.size(), kContestGrain, [&](std::size_t begin, std::size_t end) {
      NodeContest here(scans, self, contest, options);
      for (std::size_t node = begin; node < end && !job.cancelled(); ++node) {
        if (contest.any[node] != 0) {
          here.enter(node);
          scans[self].surface->lattice.for_each_sample(
              node, [&](std::size_t i) { fresh[i] = fresh[i] != 0 && !here.is_taken(i) ? 1 : 0; });
        }
      }
    });
    if (job.cancelled()) {
      return false;
    }
    add_samples(scans, self, std::move(fresh), contest, grid, options, options.least_wanted_patch_samples,
                laid, job);
  }
  // What nobody keeps goes to the first scan that has it.
  for (std::size_t self = 0; self < scans.size(); ++self) {
    if (job.cancelled()) {
      return false;
    }
    job.progress("cover what is left", static_cast<double>(self + scans.size()) / steps);
    OwnedScan& scan = scans[self];
    const Contest contest = contest_of(scans, self);
    const std::vector<std::uint32_t> uncovered = uncovered_samples(scans, self, contest, options, job);
    if (uncovered.empty()) {
      continue;
    }
    std::vector<std::uint32_t> unfused;
    std::vector<std::uint8_t> fresh(scan.kept.size(), 0);
    for (const std::uint32_t i : uncovered) {
      fresh[i] = 1;
    }
    drop_scattered(fresh, scan.kept, scan.surface->lattice, options.least_patch_samples);
    for (const std::uint32_t i : uncovered) {
      if (scan.fused->slot[i] == FusedSamples::kNone) {
        unfused.push_back(i);
      }
    }
    scan.fuse(unfused, job);
    if (job.cancelled()) {  // then they have no places
      return false;
    }
    add_samples(scans, self, std::move(fresh), contest, grid, options, options.least_patch_samples, laid,
                job);
    std::ranges::copy_if(uncovered, std::back_inserter(scan.loose),
                         [&](std::uint32_t i) { return scan.kept[i] == 0; });
  }
  return !job.cancelled();
}

}  // namespace dubsar
