// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/signs.h"

#include <algorithm>
#include <array>

#include "core/units.h"

namespace dubsar::sim {

namespace {

using enum StrokeKind;

void stack_horizontals(Sign& sign, double x, int count, double length, double low, double high) {
  for (int i = 0; i < count; ++i) {
    const double y = count == 1 ? 0.5 * (low + high) : high - (high - low) * i / (count - 1);
    sign.strokes.push_back({kHorizontal, x, y, length});
  }
}

void row_of_verticals(Sign& sign, double x, int count, double step, double top, double length) {
  for (int i = 0; i < count; ++i) {
    sign.strokes.push_back({kVertical, x + step * i, top, length});
  }
}

/// Groups by how often they turn up in signs.
constexpr std::array<int, 16> kGroups = {0, 1, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8, 9, 9};

/// Adds one group at x and returns its width.
double add_group(Sign& sign, double x, Random& random) {
  const int count = 2 + static_cast<int>(random.below(2));
  switch (kGroups[random.below(kGroups.size())]) {
    case 0:
      row_of_verticals(sign, x + 0.16, 1, 0, 1.0, 0.95);
      return 0.36;
    case 1:
      row_of_verticals(sign, x + 0.16, count, 0.30, 1.0, 0.9);
      return 0.30 * count + 0.06;
    case 2:  // two rows of short verticals, as numbers are written
      row_of_verticals(sign, x + 0.16, count, 0.31, 1.0, 0.46);
      row_of_verticals(sign, x + 0.16, count, 0.31, 0.5, 0.46);
      return 0.31 * count + 0.06;
    case 3:
      stack_horizontals(sign, x, 1, 0.75, 0.4, 0.6);
      return 0.8;
    case 4:
      stack_horizontals(sign, x, count, 0.7, 0.2, 0.82);
      return 0.75;
    case 5:  // horizontals closed by a vertical that overwrites their tails
      stack_horizontals(sign, x, count, 0.72, 0.18, 0.8);
      row_of_verticals(sign, x + 0.66, 1, 0, 1.0, 0.95);
      return 0.86;
    case 6:  // a star: horizontal, oblique and vertical through one place
      sign.strokes.push_back({kHorizontal, x, 0.52, 0.85});
      sign.strokes.push_back({kDown, x + 0.12, 0.86, 0.75});
      sign.strokes.push_back({kVertical, x + 0.42, 1.0, 0.95});
      return 0.92;
    case 7:
      for (int i = 0; i < count - 1; ++i) {
        sign.strokes.push_back({kWinkelhaken, x + 0.2 + 0.34 * i, 0.55, 0.4});
      }
      return 0.34 * count + 0.02;
    case 8:  // a box with something in it
      row_of_verticals(sign, x + 0.14, 1, 0, 1.0, 0.92);
      stack_horizontals(sign, x + 0.14, 2, 0.8, 0.14, 0.86);
      if (random.uniform() < 0.6) {
        sign.strokes.push_back({kWinkelhaken, x + 0.55, 0.5, 0.3});
      } else {
        stack_horizontals(sign, x + 0.32, 1, 0.45, 0.5, 0.5);
      }
      row_of_verticals(sign, x + 0.92, 1, 0, 1.0, 0.92);
      return 1.08;
    default:  // two obliques that meet, before a vertical
      sign.strokes.push_back({kDown, x + 0.02, 0.88, 0.55});
      sign.strokes.push_back({kUp, x + 0.02, 0.14, 0.55});
      row_of_verticals(sign, x + 0.58, 1, 0, 1.0, 0.92);
      return 0.78;
  }
}

}  // namespace

Sign make_sign(Random& random) {
  Sign sign;
  sign.width = 0;
  const int groups = 1 + static_cast<int>(random.below(3));
  for (int i = 0; i < groups; ++i) {
    sign.width += add_group(sign, sign.width, random) + 0.04;
  }
  return sign;
}

Stroke write_stroke(const SignStroke& stroke, const Hand& hand, Random& random) {
  const auto jitter = [&](double scale) { return scale * std::clamp(random.normal(), -2.5, 2.5); };
  const double unit = 0.84 * hand.line_height_mm;
  const double y = unit * stroke.y + jitter(0.4 * hand.unsteadiness * unit);
  const double x = unit * stroke.x + jitter(0.4 * hand.unsteadiness * unit);
  const Eigen::Vector2d at(x, y);
  const double width = hand.head_width * hand.line_height_mm * (1.0 + jitter(1.4 * hand.unsteadiness));
  const double depth = width * hand.depth * (1.0 + jitter(hand.unsteadiness));
  // A wedge shorter than this has no tail left and would turn its directional edge about.
  const double length = std::max(1.35 * width, unit * stroke.length * (1.0 + jitter(hand.unsteadiness)));
  const double turn = hand.slant_rad + jitter(0.8 * hand.unsteadiness);
  const double slope = hand.head_slope_rad + jitter(0.5 * hand.unsteadiness);
  switch (stroke.kind) {
    case StrokeKind::kHorizontal:
      return long_wedge(at, turn, length, width, depth, slope);
    case StrokeKind::kVertical:
      return long_wedge(at, -0.5 * kPi + turn, length, width, depth, slope);
    case StrokeKind::kDown:
      return long_wedge(at, -0.25 * kPi + turn, length, width, depth, slope);
    case StrokeKind::kUp:
      return long_wedge(at, 0.25 * kPi + turn, length, width, depth, slope);
    case StrokeKind::kWinkelhaken:
      break;
  }
  return winkelhaken(at, 0.98 * kPi + turn, 1.5 * width, 1.05 * depth);
}

}  // namespace dubsar::sim
