// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/outline.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "archive/render.h"

namespace dubsar {

namespace {

constexpr double kSpeckPx2 = 16;
constexpr double kSlackPx = 0.6;

/// Corners between pixels, x to the right, y downwards.
using Corner = std::array<int, 2>;

/// Edges between covered and empty pixels, walked with the covered side on the left.
class Tracer {
 public:
  explicit Tracer(const VisibilityBuffer& buffer)
      : buffer_(buffer),
        seen_(static_cast<std::size_t>(buffer.width + 1) * static_cast<std::size_t>(buffer.height + 1)) {}

  [[nodiscard]] bool covered(int x, int y) const {
    return x >= 0 && y >= 0 && x < buffer_.width && y < buffer_.height &&
           buffer_.id[static_cast<std::size_t>(y) * static_cast<std::size_t>(buffer_.width) +
                      static_cast<std::size_t>(x)] != kNothing;
  }
  /// The ring through the upper edge of pixel (x, y), which is covered while the one above it is not; empty
  /// when it was walked before.
  [[nodiscard]] std::vector<Corner> ring(int x, int y) {
    Corner at{x + 1, y};
    int way = 2;  // to the left, the covered pixel below: on the left hand with y downwards
    std::vector<Corner> corners;
    if (seen(at)) {
      return corners;
    }
    const Corner first = at;
    do {
      if (way == 2) {
        mark(at);
      }
      corners.push_back(at);
      at = {at[0] + kStep[static_cast<std::size_t>(way)][0], at[1] + kStep[static_cast<std::size_t>(way)][1]};
      // Diagonal neighbours count as apart: the sharpest turn towards the covered side first.
      for (const int turn : {3, 0, 1}) {
        const int next = (way + turn) % 4;
        if (is_edge(at, next)) {
          way = next;
          break;
        }
      }
    } while (at != first || way != 2);
    return corners;
  }

 private:
  // right, down, left, up
  static constexpr std::array<std::array<int, 2>, 4> kStep = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

  /// Whether the step runs between a covered pixel on its left and an empty one on its right. With y
  /// downwards the left hand of a step to the right is above it.
  [[nodiscard]] bool is_edge(const Corner& at, int way) const {
    const auto [x, y] = at;
    switch (way) {
      case 0:
        return covered(x, y - 1) && !covered(x, y);
      case 1:
        return covered(x, y) && !covered(x - 1, y);
      case 2:
        return covered(x - 1, y) && !covered(x - 1, y - 1);
      default:
        return covered(x - 1, y - 1) && !covered(x, y - 1);
    }
  }
  [[nodiscard]] std::size_t index(const Corner& c) const {
    return static_cast<std::size_t>(c[1]) * static_cast<std::size_t>(buffer_.width + 1) +
           static_cast<std::size_t>(c[0]);
  }
  [[nodiscard]] bool seen(const Corner& c) const { return seen_[index(c)] != 0; }
  void mark(const Corner& c) { seen_[index(c)] = 1; }

  const VisibilityBuffer& buffer_;
  std::vector<std::uint8_t> seen_;  ///< by corner that a step to the left begins at
};

double area_px2(const std::vector<Eigen::Vector2d>& ring) {
  double twice = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

/// Ramer 1972, Douglas and Peucker 1973, without recursion.
void keep_needed(const std::vector<Eigen::Vector2d>& line, std::size_t from, std::size_t to,
                 std::vector<bool>& keep) {
  std::vector<std::pair<std::size_t, std::size_t>> open{{from, to}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    const Eigen::Vector2d along = line[b] - line[a];
    const double length = along.norm();
    double most = kSlackPx;
    std::size_t at = 0;
    for (std::size_t i = a + 1; i < b; ++i) {
      const Eigen::Vector2d off = line[i] - line[a];
      const double away =
          length > 0 ? std::abs(along.x() * off.y() - along.y() * off.x()) / length : off.norm();
      if (away > most) {
        most = away;
        at = i;
      }
    }
    if (at != 0) {
      keep[at] = true;
      open.emplace_back(a, at);
      open.emplace_back(at, b);
    }
  }
}

std::vector<Eigen::Vector2d> simplified(std::vector<Eigen::Vector2d> ring) {
  std::size_t far = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if ((ring[i] - ring[0]).squaredNorm() > (ring[far] - ring[0]).squaredNorm()) {
      far = i;
    }
  }
  ring.push_back(ring.front());
  std::vector<bool> keep(ring.size(), false);
  keep[0] = keep[far] = true;
  keep_needed(ring, 0, far, keep);
  keep_needed(ring, far, ring.size() - 1, keep);
  std::vector<Eigen::Vector2d> out;
  for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
    if (keep[i]) {
      out.push_back(ring[i]);
    }
  }
  return out;
}

}  // namespace

Result<std::vector<OutlineRing>> outline_of(const RenderScene& scene, const ViewCamera& camera,
                                            int longest_px) {
  RenderOptions options;
  options.longest_px = longest_px;
  options.margin_px = 1;
  const Result<Framing> framing = framing_of(scene, camera, options);
  if (!framing) {
    return std::unexpected(framing.error());
  }
  const VisibilityBuffer buffer = rasterise(scene, camera, *framing, 1);
  Tracer tracer(buffer);
  std::vector<OutlineRing> rings;
  for (int y = 0; y < buffer.height; ++y) {
    for (int x = 0; x < buffer.width; ++x) {
      if (!tracer.covered(x, y) || tracer.covered(x, y - 1)) {
        continue;
      }
      std::vector<Eigen::Vector2d> ring;
      for (const Corner& c : tracer.ring(x, y)) {
        ring.emplace_back(c[0], c[1]);
      }
      if (std::abs(area_px2(ring)) < kSpeckPx2) {
        continue;
      }
      ring = simplified(std::move(ring));
      for (Eigen::Vector2d& p : ring) {
        p = {framing->left_mm + p.x() * framing->mm_per_px, framing->top_mm - p.y() * framing->mm_per_px};
      }
      rings.push_back(std::move(ring));
    }
  }
  return rings;
}

}  // namespace dubsar
