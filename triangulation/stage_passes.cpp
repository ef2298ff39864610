// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/stage_passes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <utility>

#include "core/grid_lookup.h"
#include "core/grid_rows.h"
#include "core/parallel.h"
#include "core/row_camera.h"

namespace dubsar {

namespace {

using Eigen::Vector3f;

/// Columns that a row is asked in, and how many of them at least must answer.
constexpr int kMostProbes = 128;
constexpr int kLeastProbes = 12;
/// The sense in which a grid's rows go on is that of the first two that say it so clearly; two that clearly
/// say the other are a way back.
constexpr double kClear = 0.75;
/// Noise does not make rows that go on less clear than this. Of a stage that stands still half of the probes
/// say either, and where it is not clear, earlier rows must lie under it, too.
constexpr double kGoesOn = 0.4;
/// Of a row's probes: the clay may be new to either side of those that lie over earlier rows.
constexpr double kLeastOver = 0.25;
/// How near, × µ as it is seen, earlier rows lie under a stage that hardly moves, ...
constexpr double kHardlyMoved = 2.0;
/// ... and under one that has not come beyond them yet.
constexpr double kNotBeyond = 0.75;
/// × µ: samples of clay measured twice lie no farther apart in depth.
constexpr double kSameClay = 3.0;
/// What lies over a place still more often stays in the last pass.
constexpr std::size_t kMostPasses = 16;

/// As if the camera stood where the laser does, where that is known: samples err along its rays, and seen
/// from there they keep their order on the steepest clay.
ScannerView view_along_errors(ScannerView view) {
  if (view.laser_mm) {
    view.camera_mm = view.laser_mm;
  }
  return view;
}

class Passes {
 public:
  Passes(const RangeGrid& grid, double spacing_mm)
      : grid_(grid),
        view_(view_along_errors(grid.view)),
        spacing_mm_(spacing_mm),
        stride_(std::max(1, grid.cols / kMostProbes)) {}

  [[nodiscard]] std::vector<StagePass> find();

 private:
  [[nodiscard]] std::optional<double> sense(int from, int to) const;
  [[nodiscard]] bool lies_over(int row, double reach);
  [[nodiscard]] std::pair<StagePass, StagePass> split(const StagePass& rows);

  const RangeGrid& grid_;
  ScannerView view_;
  double spacing_mm_;
  int stride_;
  std::optional<GridLookup> lookup_{};   ///< of all samples; made when it is first asked
  std::vector<std::uint8_t> in_pass_{};  ///< by row: 1 for those of the pass that is being made
};

/// How far the probes agree on which way round the row `to` follows `from`, as they are seen: from -1
/// to 1, the same sign where rows go on in the same sense. Nothing where too few answer.
std::optional<double> Passes::sense(int from, int to) const {
  const RowCamera eye(view_, from);
  const auto most = static_cast<float>(2 * spacing_mm_);
  int votes = 0;
  int probes = 0;
  for (int col = 0; col + 1 < grid_.cols; col += stride_) {
    const std::size_t i = grid_.index(from, col);
    const std::size_t k = grid_.index(to, col);
    const Vector3f p = grid_.point(i);
    const Vector3f along = grid_.point(i + 1) - p;
    if (grid_.valid[i] != 0 && grid_.valid[i + 1] != 0 && grid_.valid[k] != 0 &&
        along.squaredNorm() < most * most) {
      const float side = (grid_.point(k) - p).cross(along).dot(eye.from(p));
      votes += side > 0 ? 1 : side < 0 ? -1 : 0;
      ++probes;
    }
  }
  return probes < kLeastProbes ? std::nullopt : std::optional(static_cast<double>(votes) / probes);
}

/// Whether enough of a row lies, × µ, within reach of rows of the pass.
bool Passes::lies_over(int row, double reach) {
  if (!lookup_) {
    lookup_.emplace(grid_, std::vector<std::uint8_t>{}, 1.5 * spacing_mm_);
  }
  const RowCamera eye(view_, row);
  const auto aside = static_cast<float>(reach * spacing_mm_);
  const auto radius = static_cast<float>(std::hypot(reach, kSameClay) * spacing_mm_);
  int over = 0;
  int probes = 0;
  for (int col = 0; col < grid_.cols; col += stride_) {
    const std::size_t i = grid_.index(row, col);
    if (grid_.valid[i] == 0) {
      continue;
    }
    const Vector3f p = grid_.point(i);
    const Vector3f ray = eye.from(p).normalized();
    const GridLookup::Reach around = lookup_->reach_of(p, radius);
    ++probes;
    over +=
        lookup_->may_hold_samples(around) &&
                lookup_->any_within(around,
                                    [&](std::uint32_t k) {
                                      return in_pass_[static_cast<std::size_t>(grid_.row_of(k))] != 0 &&
                                             (grid_.point(k) - p).cross(ray).squaredNorm() < aside * aside;
                                    })
            ? 1
            : 0;
  }
  return probes >= kLeastProbes && over >= kLeastOver * probes;
}

/// A pass, and the rows that are none of it.
std::pair<StagePass, StagePass> Passes::split(const StagePass& rows) {
  std::vector<std::optional<double>> senses(rows.size() - 1);
  parallel_for_each_index(
      senses.size(), [&](std::size_t k) { senses[k] = sense(rows[k], rows[k + 1]); }, 16);
  const auto clear = std::ranges::find_if(senses, [](const auto& s) { return s && std::abs(*s) >= kClear; });
  const double turn = clear == senses.end() || **clear > 0 ? 1.0 : -1.0;
  const auto goes_on = [&](const std::optional<double>& s) { return s && turn * *s >= kGoesOn; };
  if (clear == senses.end() || std::ranges::all_of(senses, [&](const auto& s) { return !s || goes_on(s); })) {
    return {rows, {}};
  }
  StagePass pass{rows.front()};
  StagePass rest;
  in_pass_.assign(static_cast<std::size_t>(grid_.rows), 0);
  in_pass_[static_cast<std::size_t>(rows.front())] = 1;
  bool behind = false;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const std::optional<double> s = behind ? sense(pass.back(), rows[k]) : senses[k - 1];
    behind = behind ? !goes_on(s) || lies_over(rows[k], kNotBeyond)
                    : s && (turn * *s <= -kClear || (!goes_on(s) && lies_over(rows[k], kHardlyMoved)));
    (behind ? rest : pass).push_back(rows[k]);
    in_pass_[static_cast<std::size_t>(rows[k])] = behind ? 0 : 1;
  }
  return {std::move(pass), std::move(rest)};
}

std::vector<StagePass> Passes::find() {
  std::vector<StagePass> passes;
  StagePass rest(static_cast<std::size_t>(grid_.rows));
  std::iota(rest.begin(), rest.end(), 0);
  for (std::size_t times = 1; times < kMostPasses && rest.size() > 1; ++times) {
    auto [pass, left] = split(rest);
    if (pass.size() > 1) {
      passes.push_back(std::move(pass));
    }
    rest = std::move(left);
  }
  if (rest.size() > 1) {
    passes.push_back(std::move(rest));
  }
  return passes;
}

}  // namespace

std::vector<StagePass> stage_passes(const RangeGrid& grid, double spacing_mm) {
  return Passes(grid, spacing_mm).find();
}

RangeGrid grid_of_pass(const RangeGrid& grid, const StagePass& pass) {
  RangeGrid out;
  for (std::size_t begin = 0, end = 0; begin < pass.size(); begin = end) {
    for (end = begin + 1; end < pass.size() && pass[end] == pass[end - 1] + 1;) {
      ++end;
    }
    append_rows(out, rows_of(grid, pass[begin], static_cast<int>(end - begin)));
  }
  return out;
}

}  // namespace dubsar
