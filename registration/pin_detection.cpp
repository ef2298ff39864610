// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pin_detection.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/grid_geometry.h"
#include "core/units.h"

namespace dubsar {

namespace {

constexpr std::array<std::array<int, 2>, 4> kFourNeighbours{{{0, 1}, {0, -1}, {1, 0}, {-1, 0}}};
/// Candidate centres tried per component: plenty for a ball of some tens of samples.
constexpr std::size_t kMostCandidates = 400;
/// A tip shows some third of its visible samples there, an arm's cut end a tenth.
constexpr double kLeastCapShare = 0.15;
/// Outliers that may lie beyond a tip, of the samples of half a ball.
constexpr double kMostStrays = 0.05;

struct Component {
  std::vector<std::uint32_t> samples;
  int most_inside = 0;  ///< largest number of steps from a sample to the component's border
};

bool finite_sample(const RangeGrid& grid, std::size_t i) {
  return grid.valid[i] != 0 && grid.point(i).allFinite();
}

/// Components of samples that hang together without a depth step.
std::vector<Component> components_of(const RangeGrid& grid, double step_mm, std::vector<int>& label) {
  label.assign(grid.size(), -1);
  const auto step2 = static_cast<float>(step_mm * step_mm);
  std::vector<Component> out;
  std::vector<std::uint32_t> stack;
  for (std::size_t seed = 0; seed < grid.size(); ++seed) {
    if (label[seed] >= 0 || !finite_sample(grid, seed)) {
      continue;
    }
    const int id = static_cast<int>(out.size());
    out.emplace_back();
    label[seed] = id;
    stack.assign(1, static_cast<std::uint32_t>(seed));
    while (!stack.empty()) {
      const std::uint32_t i = stack.back();
      stack.pop_back();
      out.back().samples.push_back(i);
      for (const auto& [dr, dc] : kFourNeighbours) {
        const int row = grid.row_of(i) + dr;
        const int col = grid.col_of(i) + dc;
        if (!grid.inside(row, col)) {
          continue;
        }
        const std::size_t j = grid.index(row, col);
        if (label[j] < 0 && finite_sample(grid, j) &&
            (grid.point(j) - grid.point(i)).squaredNorm() <= step2) {
          label[j] = id;
          stack.push_back(static_cast<std::uint32_t>(j));
        }
      }
    }
    std::sort(out.back().samples.begin(), out.back().samples.end());
  }
  return out;
}

/// Steps from each sample to the border of its component, in two passes over the grid.
void measure_inside(const RangeGrid& grid, const std::vector<int>& label,
                    std::vector<Component>& components) {
  std::vector<int> steps(grid.size(), 0);
  const auto from = [&](std::size_t i, int row, int col) {
    return grid.inside(row, col) && label[grid.index(row, col)] == label[i] ? steps[grid.index(row, col)] + 1
                                                                            : 1;
  };
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (label[i] >= 0) {
      steps[i] =
          std::min(from(i, grid.row_of(i) - 1, grid.col_of(i)), from(i, grid.row_of(i), grid.col_of(i) - 1));
    }
  }
  for (std::size_t i = grid.size(); i-- > 0;) {
    if (label[i] >= 0) {
      const int back =
          std::min(from(i, grid.row_of(i) + 1, grid.col_of(i)), from(i, grid.row_of(i), grid.col_of(i) + 1));
      steps[i] = std::min(steps[i], back);
      Component& c = components[static_cast<std::size_t>(label[i])];
      c.most_inside = std::max(c.most_inside, steps[i]);
    }
  }
}

struct Ball {
  bool tip = false;  ///< it shows its cap; else it is the cut end of an arm
  Eigen::Vector3d center{0, 0, 0};
  int support = 0;
  double rms_mm = 0;
};

/// Samples of the component within `tolerance` of the sphere.
int support_of(const RangeGrid& grid, const Component& component, const Eigen::Vector3d& center,
               double radius, double tolerance) {
  int count = 0;
  for (const std::uint32_t i : component.samples) {
    const double d = (grid.point(i).cast<double>() - center).norm();
    count += std::abs(d - radius) <= tolerance ? 1 : 0;
  }
  return count;
}

/// Fixed-radius least squares on the samples near the sphere.
Ball refine(const RangeGrid& grid, const Component& component, Eigen::Vector3d center, double radius,
            double tolerance) {
  Ball ball;
  for (int iteration = 0; iteration < 10; ++iteration) {
    Eigen::Matrix3d h = 1e-9 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    double sum2 = 0;
    int count = 0;
    for (const std::uint32_t i : component.samples) {
      const Eigen::Vector3d d = grid.point(i).cast<double>() - center;
      const double length = d.norm();
      const double r = length - radius;
      if (length > 1e-9 && std::abs(r) <= tolerance) {
        const Eigen::Vector3d n = d / length;
        h += n * n.transpose();
        g += r * n;
        sum2 += r * r;
        ++count;
      }
    }
    if (count < 4) {
      return {};
    }
    ball = {false, center, count, std::sqrt(sum2 / count)};
    const Eigen::Vector3d step = h.ldlt().solve(g);
    if (!step.allFinite()) {
      return {};
    }
    center += step;
    if (step.norm() < 1e-6 * radius) {
      break;
    }
  }
  return ball;
}

/// A ball is a tip when it ends its pin: no more than `strays` samples of the component lie beyond it, seen
/// from the arm. A cone holds balls all along; only the last is the tip.
bool ends_pin(const RangeGrid& grid, const Component& component, const Eigen::Vector3d& center, double radius,
              std::size_t strays) {
  Eigen::Vector3d arm = Eigen::Vector3d::Zero();
  for (const std::uint32_t i : component.samples) {
    arm += grid.point(i).cast<double>() - center;
  }
  if (arm.norm() < 1e-9) {
    return true;
  }
  arm.normalize();
  std::size_t beyond = 0;
  for (const std::uint32_t i : component.samples) {
    beyond += (grid.point(i).cast<double>() - center).dot(arm) < -1.3 * radius ? 1U : 0U;
  }
  return beyond <= strays;
}

/// Share of the ball's samples on its cap, away from the arm. Where the field cuts an arm off, a ball fits
/// its end too, but only around its waist.
double cap_share(const RangeGrid& grid, const Component& component, const Ball& ball, double radius,
                 double tolerance) {
  Eigen::Vector3d arm = Eigen::Vector3d::Zero();
  for (const std::uint32_t i : component.samples) {
    arm += grid.point(i).cast<double>() - ball.center;
  }
  arm.normalize();
  int cap = 0;
  for (const std::uint32_t i : component.samples) {
    const Eigen::Vector3d d = grid.point(i).cast<double>() - ball.center;
    cap += std::abs(d.norm() - radius) <= tolerance && d.dot(arm) < -0.4 * radius ? 1 : 0;
  }
  return ball.support > 0 ? static_cast<double>(cap) / ball.support : 0.0;
}

std::optional<Ball> find_ball(const RangeGrid& grid, const GridGeometry& geometry, const Component& component,
                              double radius, double spacing_mm, const PinDetectionOptions& options) {
  const double tolerance = options.ball_tolerance * radius;
  const std::size_t tried = std::min(component.samples.size(), kMostCandidates);
  const double half_ball = kPi * radius * radius / (spacing_mm * spacing_mm);
  const auto strays = static_cast<std::size_t>(std::max(1.0, kMostStrays * half_ball));
  std::vector<std::pair<int, Eigen::Vector3d>> candidates;
  for (std::size_t k = 0; k < tried; ++k) {
    const std::uint32_t i = component.samples[(2 * k + 1) * component.samples.size() / (2 * tried)];
    if (geometry.normals[i].isZero()) {
      continue;
    }
    const Eigen::Vector3d center = grid.point(i).cast<double>() - radius * geometry.normals[i].cast<double>();
    if (!ends_pin(grid, component, center, radius, strays)) {
      continue;
    }
    candidates.emplace_back(support_of(grid, component, center, radius, 2.0 * tolerance), center);
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::optional<Ball> cut_end;
  for (std::size_t k = 0; k < std::min<std::size_t>(candidates.size(), 100); ++k) {
    const Ball rough = refine(grid, component, candidates[k].second, radius, 2.0 * tolerance);
    if (rough.support < 4) {
      continue;
    }
    Ball ball = refine(grid, component, rough.center, radius, tolerance);
    if (ball.support < std::max(6.0, options.least_ball_share * half_ball) ||
        ball.rms_mm > options.most_ball_rms * radius ||
        !ends_pin(grid, component, ball.center, radius, strays)) {
      continue;
    }
    ball.tip = cap_share(grid, component, ball, radius, tolerance) >= kLeastCapShare;
    if (ball.tip) {
      return ball;
    }
    cut_end = cut_end ? cut_end : ball;
  }
  return cut_end;
}

}  // namespace

PinDetection detect_pins(const RangeGrid& grid, double tip_diameter_mm, const PinDetectionOptions& options) {
  PinDetection out;
  out.mask.assign(grid.size(), 0);
  const double spacing_mm = grid.spacing_mm > 0 ? grid.spacing_mm : estimate_spacing_mm(grid);
  // Fewer than some four samples across the ball cannot tell it from anything else.
  if (!(tip_diameter_mm > 0) || !(spacing_mm > 0) || tip_diameter_mm < 3.5 * spacing_mm) {
    return out;
  }
  std::vector<int> label;
  std::vector<Component> components = components_of(grid, options.step_factor * spacing_mm, label);
  measure_inside(grid, label, components);
  RangeGrid spaced;  // grid_geometry wants a spacing
  const RangeGrid* known = &grid;
  if (!(grid.spacing_mm > 0)) {
    spaced = grid;
    spaced.spacing_mm = spacing_mm;
    known = &spaced;
  }
  const GridGeometry geometry = grid_geometry(*known, options.step_factor);
  const double most_samples = options.most_share * static_cast<double>(grid.valid_count());
  const double radius = 0.5 * tip_diameter_mm;
  std::vector<std::size_t> thin;
  std::vector<std::size_t> pins;
  for (std::size_t c = 0; c < components.size(); ++c) {
    const Component& component = components[c];
    const double width_mm = (2.0 * component.most_inside - 1.0) * spacing_mm;
    if (width_mm > options.most_width * tip_diameter_mm ||
        static_cast<double>(component.samples.size()) > most_samples) {
      continue;
    }
    thin.push_back(c);
    if (const std::optional<Ball> ball = find_ball(grid, geometry, component, radius, spacing_mm, options)) {
      if (ball->tip) {
        out.tips.push_back({-1, ball->center});
        out.rms_mm.push_back(ball->rms_mm);
      }
      pins.push_back(c);
    }
  }
  // Pieces of an arm that occlusion cut off, by their nearness to a pin.
  const auto near2 = static_cast<float>(std::pow(1.5 * tip_diameter_mm, 2.0));
  const auto touches_pin = [&](const Component& piece) {
    const std::size_t step = std::max<std::size_t>(1, piece.samples.size() / 64);
    for (const std::size_t p : pins) {
      const std::vector<std::uint32_t>& pin = components[p].samples;
      const std::size_t pin_step = std::max<std::size_t>(1, pin.size() / 256);
      for (std::size_t a = 0; a < piece.samples.size(); a += step) {
        for (std::size_t b = 0; b < pin.size(); b += pin_step) {
          if ((grid.point(piece.samples[a]) - grid.point(pin[b])).squaredNorm() < near2) {
            return true;
          }
        }
      }
    }
    return false;
  };
  for (const std::size_t c : thin) {
    if (std::binary_search(pins.begin(), pins.end(), c) || touches_pin(components[c])) {
      for (const std::uint32_t i : components[c].samples) {
        out.mask[i] = 1;
      }
    }
  }
  return out;
}

std::vector<std::uint8_t> pin_mask(const RangeGrid& grid, double tip_diameter_mm,
                                   const PinDetectionOptions& options) {
  return detect_pins(grid, tip_diameter_mm, options).mask;
}

std::vector<PinTip> labelled_tips(const std::vector<PinTip>& detected, const std::vector<PinTip>& clicked,
                                  double tip_diameter_mm) {
  const double reach_mm = tip_diameter_mm + 1.0;
  std::vector<PinTip> out;
  std::vector<bool> used(detected.size(), false);
  for (const PinTip& click : clicked) {
    std::size_t best = detected.size();
    double best_mm = reach_mm;
    for (std::size_t k = 0; k < detected.size(); ++k) {
      const double d = (detected[k].position_mm - click.position_mm).norm();
      if (!used[k] && d < best_mm) {
        best = k;
        best_mm = d;
      }
    }
    if (best < detected.size()) {
      used[best] = true;
      out.push_back({click.label, detected[best].position_mm});
    } else if (click.position_mm.allFinite()) {
      out.push_back(click);
    }
  }
  for (std::size_t k = 0; k < detected.size(); ++k) {
    if (!used[k]) {
      out.push_back(detected[k]);
    }
  }
  return out;
}

}  // namespace dubsar
