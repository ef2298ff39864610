// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/text_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "analysis/text_lines.h"
#include "core/tablet_frame.h"
#include "core/tablet_sides.h"
#include "core/units.h"

namespace dubsar {

namespace {

/// A normal leans to a broad side when this much of it does.
constexpr double kBroadSide = 0.6;
/// The side that looks along the tablet frame's z is the obverse unless the other has so much more text.
constexpr double kMoreText = 1.25;

/// Fewer votes that count (their sum squared over the sum of their squares) are chance: two hollows of a body
/// without text that happened to lean the same way turned its pictures.
constexpr double kFewestVotes = 5.0;

Eigen::Vector3d tail_of(const Wedge& wedge) {
  return (wedge.exit_points_surface_mm[static_cast<std::size_t>(wedge.directional_edge)] -
          wedge.depth_point_mm)
      .normalized();
}

/// A short wedge says little of where it points.
double vote_of(const Wedge& wedge) {
  return wedge.confidence * std::clamp(2.0 * wedge.directional_margin, 0.0, 1.0);
}

Face side_of(const Eigen::Vector3d& normal) {
  if (std::abs(normal.z()) > kBroadSide) {
    return normal.z() > 0 ? Face::kObverse : Face::kReverse;
  }
  if (std::abs(normal.x()) > std::abs(normal.y())) {
    return normal.x() < 0 ? Face::kLeft : Face::kRight;
  }
  return normal.y() > 0 ? Face::kTop : Face::kBottom;
}

}  // namespace

TextFrame find_text_frame(const Mesh& mesh, const std::vector<Wedge>& wedges) {
  const RigidTransform tablet_from_model = tablet_frame(mesh);
  TextFrame frame;
  frame.text_from_model = tablet_from_model;
  std::array<double, 2> text{};
  std::array<double, 4> reading{};
  double votes = 0;
  double squared_votes = 0;
  for (const Wedge& wedge : wedges) {
    const Eigen::Vector3d normal = tablet_from_model.rotation * wedge.surface_normal;
    if (std::abs(normal.z()) < kBroadSide) {
      continue;
    }
    text[normal.z() > 0 ? 0 : 1] += wedge.confidence;
    const Eigen::Vector3d tail = tablet_from_model.rotation * tail_of(wedge);
    const double vote = vote_of(wedge);
    votes += vote;
    squared_votes += vote * vote;
    for (std::size_t turn = 0; turn < 4; ++turn) {
      const double angle = 0.5 * kPi * static_cast<double>(turn);
      const Eigen::Vector3d right(std::cos(angle), std::sin(angle), 0);
      const Eigen::Vector3d up = Eigen::Vector3d(0, 0, normal.z() > 0 ? 1 : -1).cross(right);
      // One lobe about the lower right: half the weight for right and for down, none for the other oblique.
      reading[turn] += vote * (tail.dot(right) - tail.dot(up)) / std::sqrt(2.0);
    }
  }
  if (!(votes > 0)) {
    return frame;
  }
  const auto best = static_cast<std::size_t>(std::ranges::max_element(reading) - reading.begin());
  std::array<double, 4> by_lead = reading;
  std::ranges::sort(by_lead);
  const bool few = votes * votes < kFewestVotes * squared_votes;
  frame.certainty = few ? 0.0 : std::clamp((by_lead[3] - by_lead[2]) / votes, 0.0, 1.0);
  if (frame.certainty < kCertainText) {
    return frame;
  }
  const double angle = 0.5 * kPi * static_cast<double>(best);
  Eigen::Matrix3d axes;  // of the text, in the tablet's frame
  axes.col(0) = Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
  axes.col(2) = Eigen::Vector3d(0, 0, text[1] > kMoreText * text[0] ? -1 : 1);
  axes.col(1) = axes.col(2).cross(axes.col(0));
  frame.text_from_model = RigidTransform{axes.transpose(), Eigen::Vector3d::Zero()} * tablet_from_model;
  return frame;
}

void place_wedges(const TextFrame& frame, std::vector<Wedge>* wedges) {
  std::map<std::pair<Face, int>, std::vector<std::size_t>> on_side;  // of one body
  std::vector<LineMember> members(wedges->size());
  for (std::size_t i = 0; i < wedges->size(); ++i) {
    Wedge& wedge = (*wedges)[i];
    const SideAxes& side = side_axes(side_of(frame.text_from_model.rotation * wedge.surface_normal));
    const Eigen::Vector3d tail = frame.text_from_model.rotation * tail_of(wedge);
    wedge.place.side = side.face;
    wedge.place.turn_rad = std::atan2(tail.dot(side.up()), tail.dot(side.right));
    LineMember& member = members[i];
    member.low = 1e30;
    member.high = -1e30;
    for (const Eigen::Vector3d& exit : wedge.exit_points_surface_mm) {
      const double v = (frame.text_from_model * exit).dot(side.up());
      member.low = std::min(member.low, v);
      member.high = std::max(member.high, v);
    }
    const Eigen::Vector3d depth_point = frame.text_from_model * wedge.depth_point_mm;
    member.along = depth_point.dot(side.right);
    on_side[{side.face, wedge.place.body}].push_back(i);
  }
  std::map<Face, int> last_line;
  for (const auto& [where, some] : on_side) {
    std::vector<LineMember> here;
    here.reserve(some.size());
    for (const std::size_t i : some) {
      here.push_back(members[i]);
    }
    find_lines(&here);
    const int before = last_line[where.first];
    for (std::size_t k = 0; k < some.size(); ++k) {
      const int line = before + here[k].line;
      last_line[where.first] = std::max(last_line[where.first], line);
      (*wedges)[some[k]].place.line = line;
      (*wedges)[some[k]].place.order = here[k].order;
    }
  }
}

}  // namespace dubsar
