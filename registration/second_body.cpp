// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/second_body.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/disjoint_sets.h"
#include "core/units.h"
#include "registration/pin_components.h"

namespace dubsar {

namespace {

constexpr int kTiles = 12;          ///< along the rows and along the columns of the scan
constexpr int kLeastSaid = 10;      ///< samples of a tile that another scan should have seen
constexpr double kDisagrees = 0.6;  ///< of them, fewer agree
constexpr std::size_t kLeastTiles = 4;
constexpr double kLeastShare = 0.05;  ///< of the samples on which another scan says something
constexpr double kLeastSheet = 0.1;   ///< of the scan's samples: what is apart and smaller is no second thing
constexpr double kConfirmed = 0.2;    ///< of its samples agree somewhere, where it lies right
constexpr double kLeastTurnRad = 0.02;
constexpr double kLeastSpacings = 3.0;  ///< a smaller shift is scan_motion.h's to find

/// What the other scans say of parts of the one that was fitted to them.
struct Surroundings {
  const ScanSurface& scan;
  std::span<const ModelScan> model;
  const ModelFit& fit;
  const ModelFitOptions& options;

  [[nodiscard]] PoseEvidence say(const SurfaceLevel& part) const {
    return evidence_of_part(part, scan, model, fit.targets, fit.model_from_scanner, options);
  }
};

/// The largest connected set of tiles; empty when there is none.
std::vector<std::size_t> largest_patch(const std::vector<bool>& flags) {
  DisjointSets sets(flags.size());
  const auto unite = [&](std::uint32_t t, std::uint32_t other) {
    if (flags[t] && flags[other]) {
      sets.unite(t, other);
    }
  };
  for (std::uint32_t row = 0; row < kTiles; ++row) {
    for (std::uint32_t col = 0; col < kTiles; ++col) {
      const std::uint32_t t = row * kTiles + col;
      const bool more_rows = row + 1 < kTiles;
      if (col + 1 < kTiles) {
        unite(t, t + 1);
        unite(t, more_rows ? t + kTiles + 1 : t);
      }
      unite(t, more_rows ? t + kTiles : t);
      unite(t, more_rows && col > 0 ? t + kTiles - 1 : t);
    }
  }
  std::map<std::uint32_t, std::vector<std::size_t>> patches;
  std::vector<std::size_t> largest;
  for (std::uint32_t t = 0; t < flags.size(); ++t) {
    if (flags[t]) {
      std::vector<std::size_t>& patch = patches[sets.root(t)];
      patch.push_back(t);
      largest = patch.size() > largest.size() ? patch : largest;
    }
  }
  return largest;
}

/// [cells of the fine grid], 1 in the part.
using Part = std::vector<std::uint8_t>;

std::size_t cell_of(const SurfaceSample& sample, const RangeGrid& grid) {
  return grid.index(static_cast<int>(std::lround(sample.row * static_cast<float>(grid.rows))),
                    static_cast<int>(std::lround(sample.col * static_cast<float>(grid.cols))));
}

std::size_t tile_of(std::size_t cell, const RangeGrid& grid) {
  const auto cols = static_cast<std::size_t>(grid.cols);
  return cell / cols * kTiles / static_cast<std::size_t>(grid.rows) * kTiles + cell % cols * kTiles / cols;
}

/// The samples of the fine level by what they belong to; `belongs` of a cell, -1 for nothing.
template <class Belongs>
std::vector<SurfaceLevel> sorted_samples(const ScanSurface& scan, std::size_t count, const Belongs& belongs) {
  std::vector<SurfaceLevel> out(count);
  for (const SurfaceSample& sample : scan.fine->samples) {
    const int to = belongs(cell_of(sample, scan.fine->grid));
    if (to >= 0) {
      out[static_cast<std::size_t>(to)].samples.push_back(sample);
    }
  }
  return out;
}

/// Things that are apart from each other in the scan, each a good part of it, that do not agree with the
/// others: also where those say nothing, for what is apart may lie anywhere.
std::vector<Part> separate_parts(const ScanSurface& scan, const Surroundings& others) {
  const RangeGrid& grid = scan.fine->grid;
  const Sheets sheets = part_at_steps(grid, {scan.fine->spacing_mm, scan.noise_mm});
  const std::vector<SurfaceLevel> by_sheet =
      sorted_samples(scan, sheets.components.size(), [&](std::size_t cell) { return sheets.label[cell]; });
  std::vector<Part> parts;
  for (std::size_t c = 0; c < by_sheet.size(); ++c) {
    const auto samples = static_cast<double>(by_sheet[c].samples.size());
    if (samples >= kLeastSheet * static_cast<double>(scan.fine->samples.size()) &&
        others.say(by_sheet[c]).close < kConfirmed * samples) {
      parts.emplace_back(grid.size());
      std::transform(sheets.label.begin(), sheets.label.end(), parts.back().begin(),
                     [&](std::int32_t label) { return label == static_cast<std::int32_t>(c) ? 1 : 0; });
    }
  }
  return parts;
}

/// A connected part of the scan on which the others say something, and disagree; none that is worth a search.
std::vector<Part> disagreeing_part(const ScanSurface& scan, const Surroundings& others) {
  const RangeGrid& grid = scan.fine->grid;
  const std::vector<SurfaceLevel> tiles = sorted_samples(
      scan, kTiles * kTiles, [&](std::size_t cell) { return static_cast<int>(tile_of(cell, grid)); });
  std::vector<bool> off(tiles.size());
  std::vector<int> said(tiles.size());
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    const PoseEvidence all = others.say(tiles[t]);
    said[t] = all.close + all.apart + all.in_front + all.missing;
    off[t] = said[t] >= kLeastSaid && all.close < kDisagrees * said[t];
  }
  const std::vector<std::size_t> patch = largest_patch(off);
  int said_of_patch = 0;
  for (const std::size_t t : patch) {
    said_of_patch += said[t];
  }
  if (patch.size() < kLeastTiles ||
      said_of_patch < kLeastShare * std::accumulate(said.begin(), said.end(), 0)) {
    return {};
  }
  Part part(grid.size());
  for (std::size_t cell = 0; cell < part.size(); ++cell) {
    part[cell] = std::binary_search(patch.begin(), patch.end(), tile_of(cell, grid)) ? 1 : 0;
  }
  return {part};
}

/// Whether the part lies there beyond doubt. Poses that were found and wrong reached a significance of 4.7
/// and a correlation of 0.24 (VerifyOptions). Free space is not asked: what is cut out has an edge of the
/// rest.
bool certain(const ModelFit& there) {
  return there.refined() && there.significance >= 5.0 && there.relief.correlation() >= 0.45 &&
         there.both().agreement() >= 0.85;
}

/// The scan with nothing in it but that part.
std::shared_ptr<const ScanSurface> cut_out(const ScanSurface& scan, const Part& part,
                                           ScanSurfaceOptions options) {
  Part rest(part.size());
  std::transform(part.begin(), part.end(), rest.begin(), [](std::uint8_t in) { return in == 0 ? 1 : 0; });
  options.scale_mm = scan.scale_mm;
  return make_scan_surface(scan.fine->grid, rest, options);
}

}  // namespace

std::optional<SecondBody> find_second_body(const ScanSurface& scan,
                                           std::span<const ScanFeatures* const> others,
                                           std::span<const ModelScan> model, const ModelFit& fit,
                                           const ScanSurfaceOptions& surface,
                                           const PoseSearchOptions& options, const JobContext& job) {
  const Surroundings around{scan, model, fit, options.fit};
  std::vector<Part> parts = separate_parts(scan, around);
  if (parts.empty()) {
    parts = disagreeing_part(scan, around);
  }
  for (const Part& part : parts) {
    const ScanFeatures body = make_scan_features(cut_out(scan, part, surface), options.align);
    const Eigen::Vector3d& middle = body.surface->centroid_mm;
    // One by one: what moved lies differently in each of the others.
    for (const std::size_t k : fit.targets) {
      const FoundPose found = search_pose(
          *body.surface, model.subspan(k, 1), {},
          [&](std::size_t) { return align_pair(body, *others[k], options.align); },
          [](const ModelFit&) { return false; }, options, job);
      for (const ModelFit& there : found.fits) {
        const RigidTransform& pose = there.model_from_scanner;
        if (certain(there) && !same_pose(pose, fit.model_from_scanner, middle, kLeastTurnRad,
                                         kLeastSpacings * scan.fine->spacing_mm)) {
          return SecondBody{(pose * fit.model_from_scanner.inverse()).angle_rad(),
                            (pose * middle - fit.model_from_scanner * middle).norm()};
        }
      }
    }
  }
  return std::nullopt;
}

std::string reason_of(const SecondBody& body) {
  return "two things in view moved against each other since another scan, by " +
         std::to_string(std::lround(deg_from_rad(body.turn_rad))) + " degrees and " +
         std::to_string(std::max(1L, std::lround(body.shift_mm))) +
         " mm; have nothing in view but the tablet, or cover what it lies on, and scan again";
}

}  // namespace dubsar
