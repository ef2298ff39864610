// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/seen_side.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "core/number_text.h"
#include "core/order_statistics.h"
#include "core/units.h"
#include "formats/grid_axis.h"

namespace dubsar {

namespace {

/// Real scans show 250 steep ends and more, of which 94 to 100 of a hundred fall away from the scanner.
constexpr std::size_t kLeastEnds = 100;
constexpr double kSteepSlope = 0.7;
constexpr double kNearlyAll = 0.9;
constexpr std::size_t kLeastFacets = 100;
/// Within this of an axis of the frame, the axis is meant.
constexpr double kNearAxisCosine = 0.85;

// The axis that rows and columns show may lie off the one that was assumed by as much as a camera looks from
// the side (the dragon's by 28 degrees: its columns follow the camera's rays), but then the laser line or the
// motion runs along an axis of the frame, square to both. Wide lenses and stages that run unevenly move it a
// little.
constexpr double kLeastTurnedDeg = 20;
constexpr double kMostObliqueDeg = 50;
constexpr double kSquareDeg = 5;
/// Of a surface that was seen along the axis, next to all facets are turned one way.
constexpr double kAllTurnedOneWay = 0.97;
constexpr double kNotTurnedOneWay = 0.95;
/// The bunny's axis shows to 16 to 58 of these, the dragon's to 14 to 32; unevenness along a flat face does
/// not.
constexpr double kClear = 8;
constexpr double kFairlyClear = 4;

enum class Witness { kFor, kAgainst, kSilent };

Witness judged(std::size_t in_favour, std::size_t all, std::size_t least) {
  const double share = all == 0 ? 0.5 : static_cast<double>(in_favour) / static_cast<double>(all);
  if (all < least || (share < kNearlyAll && share > 1.0 - kNearlyAll)) {
    return Witness::kSilent;
  }
  return share >= kNearlyAll ? Witness::kFor : Witness::kAgainst;
}

struct Ends {
  std::size_t steep = 0;
  std::size_t falling = 0;  ///< of those: away from the scanner
  void add(double slope) {
    steep += std::abs(slope) > kSteepSlope ? 1 : 0;
    falling += slope > kSteepSlope ? 1 : 0;
  }
};

/// The slopes at the ends of the runs of valid samples along rows and columns, outwards.
class Outline {
 public:
  Outline(const RangeGrid& grid, const Eigen::Vector3d& direction) : grid_(grid), direction_(direction) {
    for (int row = 0; row < grid.rows; ++row) {
      walk(grid.index(row, 0), 1, grid.cols);
    }
    for (int col = 0; col < grid.cols; ++col) {
      walk(static_cast<std::size_t>(col), grid.cols, grid.rows);
    }
  }

  /// Whether it was seen along the direction. Holes have a far side too: they are asked only where a
  /// background fills the outline.
  [[nodiscard]] Witness seen_so() const {
    const Ends& ends = outermost_.steep >= kLeastEnds ? outermost_ : all_;
    return judged(ends.falling, ends.steep, kLeastEnds);
  }

 private:
  void walk(std::size_t first, std::ptrdiff_t step, int count) {
    const auto cell = [&](int k) {
      return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(first) + k * step);
    };
    const auto valid = [&](int k) { return grid_.valid[cell(k)] != 0; };
    int first_valid = 0;
    while (first_valid < count && !valid(first_valid)) {
      ++first_valid;
    }
    int last_valid = count - 1;
    while (last_valid > first_valid && !valid(last_valid)) {
      --last_valid;
    }
    for (int k = first_valid; k < count && k <= last_valid; ++k) {
      if (!valid(k)) {
        continue;
      }
      // At the edge of the field nothing is known of what follows.
      if (k > 0 && !valid(k - 1)) {
        end(cell, k, 1, last_valid, k == first_valid);
      }
      if (k + 1 < count && !valid(k + 1)) {
        end(cell, k, -1, k - first_valid, k == last_valid);
      }
    }
  }

  template <class Cell>
  void end(const Cell& cell, int at, int inward, int room, bool outermost) {
    std::array<double, 3> slopes{};
    const int reach = inward > 0 ? room - at : room;
    if (reach < static_cast<int>(slopes.size())) {
      return;
    }
    for (int k = 0; k < static_cast<int>(slopes.size()); ++k) {
      const std::size_t outer = cell(at + k * inward);
      const std::size_t inner = cell(at + (k + 1) * inward);
      if (grid_.valid[inner] == 0) {
        return;
      }
      const Eigen::Vector3d d = (grid_.point(outer) - grid_.point(inner)).cast<double>();
      const double deeper = direction_.dot(d);
      slopes[static_cast<std::size_t>(k)] = deeper / std::max((d - deeper * direction_).norm(), 1e-9);
    }
    const double middle = value_at_rank(slopes, 1);
    all_.add(middle);
    if (outermost) {
      outermost_.add(middle);
    }
  }

  const RangeGrid& grid_;
  Eigen::Vector3d direction_;
  Ends outermost_;
  Ends all_;
};

template <class Take>
void for_each_facet(const RangeGrid& grid, const Take& take) {
  for (int row = 0; row + 1 < grid.rows; ++row) {
    for (int col = 0; col + 1 < grid.cols; ++col) {
      if (grid.is_valid(row, col) && grid.is_valid(row, col + 1) && grid.is_valid(row + 1, col)) {
        const Eigen::Vector3f at = grid.point(grid.index(row, col));
        const Eigen::Vector3d along_row = (grid.point(grid.index(row, col + 1)) - at).cast<double>();
        const Eigen::Vector3d along_col = (grid.point(grid.index(row + 1, col)) - at).cast<double>();
        take(Eigen::Vector3d(along_row.cross(along_col)));
      }
    }
  }
}

struct Facing {
  std::size_t facing = 0;
  std::size_t all = 0;
  /// Of the facets that are turned one way, those that are turned the way of most.
  [[nodiscard]] double one_way() const {
    return all == 0 ? 0.0 : static_cast<double>(std::max(facing, all - facing)) / static_cast<double>(all);
  }
};

Facing facing_of(const RangeGrid& grid, const Eigen::Vector3d& direction) {
  Facing out;
  for_each_facet(grid, [&](const Eigen::Vector3d& normal) {
    out.facing += normal.dot(direction) < 0 ? 1 : 0;
    ++out.all;
  });
  return out;
}

/// Whether the turn from columns to rows is anticlockwise as seen along a direction.
Witness anticlockwise(const RangeGrid& grid, const Eigen::Vector3d& direction) {
  const Facing facing = facing_of(grid, direction);
  return judged(facing.facing, facing.all, kLeastFacets);
}

/// The axis of a grid whose frame is plainly not the scanner's, so that it was not seen along `said`.
std::optional<Eigen::Vector3d> axis_of_another_frame(const RangeGrid& grid, const Eigen::Vector3d& said) {
  const std::optional<GridAxis> found = grid_axis(grid);
  if (!found || found->clearness < kFairlyClear) {
    return std::nullopt;
  }
  const Eigen::Vector3d& axis = found->axis;
  const double turned_deg = deg_from_rad(std::acos(std::min(1.0, std::abs(axis.dot(said)))));
  bool square = false;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d across = Eigen::Vector3d::Unit(k);
    const double along =
        std::max(std::abs(across.dot(found->along_rows)), std::abs(across.dot(found->along_cols)));
    square = square || (std::abs(across.dot(said)) < 0.5 &&
                        std::abs(across.dot(axis)) < std::sin(rad_from_deg(kSquareDeg)) &&
                        along > std::cos(rad_from_deg(kSquareDeg)));
  }
  if (turned_deg < kLeastTurnedDeg || (square && turned_deg < kMostObliqueDeg) ||
      facing_of(grid, axis).one_way() < kAllTurnedOneWay) {
    return std::nullopt;
  }
  if (found->clearness < kClear && facing_of(grid, said).one_way() > kNotTurnedOneWay) {
    return std::nullopt;
  }
  return axis;
}

std::string text_of(const Eigen::Vector3d& v) {
  std::string text;
  for (const double component : v) {
    const double rounded = std::round(component * 1e4) / 1e4;
    text.append(text.empty() ? "" : " ").append(number_text(rounded == 0 ? 0.0 : rounded));
  }
  return text;
}

std::string header_line(const Eigen::Vector3d& direction) {
  return "`obj_info dubsar_direction " + text_of(direction) + "`";
}

/// The side along an axis: what the outline says, or else the turn from columns to rows.
Eigen::Vector3d side_along(const RangeGrid& grid, const Eigen::Vector3d& axis) {
  const Eigen::Vector3d turned = anticlockwise(grid, axis) == Witness::kFor ? axis : Eigen::Vector3d(-axis);
  return Outline(grid, turned).seen_so() == Witness::kAgainst ? Eigen::Vector3d(-turned) : turned;
}

}  // namespace

int outline_side(const RangeGrid& grid) {
  const Witness outline = Outline(grid, grid.view.direction).seen_so();
  return outline == Witness::kSilent ? 0 : outline == Witness::kFor ? 1 : -1;
}

bool take_shown_axis(RangeGrid& grid) {
  const std::optional<Eigen::Vector3d> axis = axis_of_another_frame(grid, grid.view.direction);
  if (axis) {
    grid.view.direction = side_along(grid, *axis);
  }
  return axis.has_value();
}

std::string settle_direction(RangeGrid& grid) {
  const Eigen::Vector3d said = grid.view.direction;
  if (take_shown_axis(grid)) {
    const Eigen::Vector3d& shown = grid.view.direction;
    const bool open = Outline(grid, shown).seen_so() == Witness::kSilent;
    return "its rows and columns show that its frame is not the scanner's: it is read as seen along " +
           text_of(shown) + (open ? ", though no outline settles from which side" : "") +
           "; better export it in the scanner's own frame, or write " + header_line(shown) +
           " in its header, with the direction from the scanner to the object";
  }
  const Witness outline = Outline(grid, said).seen_so();
  const Witness turn = anticlockwise(grid, said);
  if (outline == Witness::kAgainst && turn == Witness::kAgainst) {
    grid.view.direction = -said;
    return "its outline and the order of its rows and columns show that it was seen along " + text_of(-said) +
           ", and so it is read; if that is wrong, write " + header_line(said) + " in its header";
  }
  if (outline == Witness::kAgainst) {
    return "its outline rises towards the scanner: if z is measured away from the scanner, export z negated, "
           "or where only the order of its rows or columns is reversed write " +
           header_line(-said) + " in its header; else write " + header_line(said);
  }
  if (outline == Witness::kSilent && turn == Witness::kAgainst) {
    return "its rows and columns run as if it was seen along " + text_of(-said) +
           ", and no outline settles it: it is read as seen along " + text_of(said) +
           "; write one of them in its header: " + header_line(-said) + ", " + header_line(said);
  }
  return {};
}

Status find_direction(RangeGrid& grid, const std::string& name) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for_each_facet(grid, [&](const Eigen::Vector3d& normal) { sum += normal; });
  if (sum.norm() > 0) {
    const std::optional<GridAxis> shown = grid_axis(grid);
    const bool clear =
        shown && shown->clearness > kClear && facing_of(grid, shown->axis).one_way() >= kAllTurnedOneWay;
    Eigen::Vector3d axis =
        clear ? Eigen::Vector3d(std::copysign(1.0, shown->axis.dot(sum)) * shown->axis) : sum.normalized();
    Eigen::Index main = 0;
    if (axis.cwiseAbs().maxCoeff(&main) > kNearAxisCosine) {
      axis = (axis[main] > 0 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(main);
    }
    const Witness outline =
        anticlockwise(grid, axis) == Witness::kSilent ? Witness::kSilent : Outline(grid, axis).seen_so();
    if (outline != Witness::kSilent) {
      grid.view.direction = outline == Witness::kFor ? axis : Eigen::Vector3d(-axis);
      return {};
    }
  }
  return bad_input(name,
                   "the scanner's position 0 0 0 lies in the scanned surface, and its outline does not "
                   "tell where it was seen from",
                   "export it in the scanner's own frame, or as range-grid PLY with `obj_info "
                   "dubsar_direction x y z`");
}

}  // namespace dubsar
