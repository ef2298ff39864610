// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/ownership.h"

#include <cmath>

#include "core/parallel.h"
#include "triangulation/contest.h"
#include "triangulation/patch_shape.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

constexpr std::uint8_t kBoth = kCellFirst | kCellSecond;
constexpr std::size_t kGrain = 2048;
constexpr std::size_t kContestGrain = 64;  ///< nodes: where there is a contest, each is much work

/// Mean of the four nodes around a sample, those that hold samples.
class NodeInterpolation {
 public:
  explicit NodeInterpolation(const StitchSurface& s) : s_(&s) {}
  [[nodiscard]] float operator()(const std::vector<float>& values, int row, int col) const {
    const Lattice& lattice = s_->lattice;
    constexpr float kSide = Lattice::kNodeSide;
    const float y = (static_cast<float>(row) + 0.5F) / kSide - 0.5F;
    const float x = (static_cast<float>(col) + 0.5F) / kSide - 0.5F;
    const int row_lo = static_cast<int>(std::floor(y));
    const int col_lo = static_cast<int>(std::floor(x));
    float sum = 0;
    float weights = 0;
    for (int r = row_lo; r <= row_lo + 1; ++r) {
      for (int c = col_lo; c <= col_lo + 1; ++c) {
        if (r < 0 || c < 0 || r >= lattice.node_rows || c >= lattice.node_cols) {
          continue;
        }
        const std::size_t node = lattice.node(r, c);
        if (s_->node_sample[node] >= 0) {
          const float w =
              (1.0F - std::abs(y - static_cast<float>(r))) * (1.0F - std::abs(x - static_cast<float>(c)));
          sum += w * values[node];
          weights += w;
        }
      }
    }
    return weights > 0 ? sum / weights : 0.0F;
  }

 private:
  const StitchSurface* s_;
};

/// Gives a scan the samples `fresh` besides those that it keeps: triangles between them that meet no other
/// patch; then the samples they use.
void add_samples(std::vector<OwnedScan>& scans, std::size_t self, std::vector<std::uint8_t> fresh,
                 const Contest& contest, const GridTriangulationOptions& grid,
                 const OwnershipOptions& options, int least_patch) {
  OwnedScan& scan = scans[self];
  const Lattice& lattice = scan.surface->lattice;
  GridSurface g = scan.surface->surface();
  std::vector<Vector3f> points(fresh.size());
  std::vector<Vector3f> normals(fresh.size());
  parallel_for_each_index(
      fresh.size(),
      [&](std::size_t i) {
        points[i] =
            scan.fused->slot[i] == FusedSamples::kNone ? scan.surface->points[i] : scan.fused->point(i);
        normals[i] = scan.surface->normal(i);
      },
      4096);
  g.points = points;
  g.normals = normals;
  std::vector<std::uint8_t> kept = std::move(scan.kept);
  std::vector<std::uint8_t> cells = std::move(scan.cells);
  kept.resize(fresh.size(), 0);
  cells.resize(fresh.size(), 0);
  // A cell is at stake when one of its corners is new.
  std::vector<std::uint8_t> anew(fresh.size(), 0);
  const auto width = static_cast<std::size_t>(g.cols);
  parallel_for_each_index(
      fresh.size(),
      [&](std::size_t i) {
        kept[i] |= fresh[i];
        anew[i] = i + width + 1 < fresh.size()
                      ? fresh[i] | fresh[i + 1] | fresh[i + width] | fresh[i + width + 1]
                      : 0;
      },
      16384);
  triangulate_cells_anew(g, kept, scan.surface->mirrored, grid, anew, cells);
  parallel_chunks(contest.any.size(), kContestGrain, [&](std::size_t begin, std::size_t end) {
    NodeContest here(scans, self, contest, options);
    for (std::size_t node = begin; node < end; ++node) {
      if (contest.any[node] == 0) {
        continue;
      }
      here.enter(node);
      lattice.for_each_sample(node, [&](std::size_t i) {
        if (anew[i] == 0) {
          return;
        }
        std::uint8_t& cell = cells[i];
        const int row = lattice.sample_row(i);
        const int col = lattice.sample_col(i);
        for (int which = 0; (cell & kBoth) != 0 && which < 2; ++which) {
          const std::uint8_t bit = which == 0 ? kCellFirst : kCellSecond;
          if ((cell & bit) != 0 && here.meets_another(points, cell_triangle(g, row, col, cell, which))) {
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
                                             const Contest& contest, const OwnershipOptions& options) {
  const OwnedScan& scan = scans[self];
  const Lattice& lattice = scan.surface->lattice;
  using Samples = std::vector<std::uint32_t>;
  Samples out = parallel_reduce_ordered(
      lattice.size(), 256, Samples{},
      [&](std::size_t begin, std::size_t end) {
        Samples found;
        NodeContest here(scans, self, contest, options);
        for (std::size_t node = begin; node < end; ++node) {
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

std::vector<std::uint8_t> wanted_samples(const std::vector<OwnedScan>& scans, std::size_t self) {
  const OwnedScan& scan = scans[self];
  const StitchSurface& s = *scan.surface;
  const Lattice& lattice = s.lattice;
  std::vector<float> wanted(lattice.size(), 0);
  parallel_chunks(wanted.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      if (s.node_sample[node] < 0) {
        continue;
      }
      bool best = true;
      for (std::size_t k = 0; best && k < scan.pairs.size(); ++k) {
        const std::int32_t j = scan.pairs[k]->match[node];
        if (j >= 0) {
          const StitchSurface& other = *scans[scan.other[k]].surface;
          const float theirs = other.score[other.lattice.node_of(static_cast<std::size_t>(j))];
          best = s.score[node] > theirs || (s.score[node] == theirs && self < scan.other[k]);
        }
      }
      wanted[node] = best ? 1.0F : 0.0F;
    }
  });
  const NodeInterpolation at(s);
  std::vector<std::uint8_t> out(s.points.size(), 0);
  parallel_for_each_index(
      static_cast<std::size_t>(lattice.rows),
      [&](std::size_t row) {
        for (int col = 0; col < lattice.cols; ++col) {
          const std::size_t i = row * static_cast<std::size_t>(lattice.cols) + static_cast<std::size_t>(col);
          out[i] = s.usable[i] != 0 && at(wanted, static_cast<int>(row), col) > 0.5F ? 1 : 0;
        }
      },
      16);
  return out;
}

bool assign_owners(std::vector<OwnedScan>& scans, const GridTriangulationOptions& grid,
                   const OwnershipOptions& options, const JobContext& job) {
  for (OwnedScan& scan : scans) {
    scan.kept.clear();
    scan.cells.clear();
    scan.near_kept.clear();
    scan.some_kept.clear();
    scan.all_kept.clear();
  }
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
      for (std::size_t node = begin; node < end; ++node) {
        if (contest.any[node] != 0) {
          here.enter(node);
          scans[self].surface->lattice.for_each_sample(
              node, [&](std::size_t i) { fresh[i] = fresh[i] != 0 && !here.is_taken(i) ? 1 : 0; });
        }
      }
    });
    add_samples(scans, self, std::move(fresh), contest, grid, options, options.least_wanted_patch_samples);
  }
  // What nobody keeps goes to the first scan that has it.
  for (std::size_t self = 0; self < scans.size(); ++self) {
    if (job.cancelled()) {
      return false;
    }
    job.progress("cover what is left", static_cast<double>(self + scans.size()) / steps);
    OwnedScan& scan = scans[self];
    const Contest contest = contest_of(scans, self);
    const std::vector<std::uint32_t> uncovered = uncovered_samples(scans, self, contest, options);
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
      if (fresh[i] != 0 && scan.fused->slot[i] == FusedSamples::kNone) {
        unfused.push_back(i);
      }
    }
    scan.fuse(unfused);
    add_samples(scans, self, std::move(fresh), contest, grid, options, options.least_patch_samples);
  }
  return true;
}

}  // namespace dubsar
