// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/turn_words.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <optional>
#include <random>
#include <regex>
#include <string>

#include "core/units.h"

namespace dubsar {
namespace {

const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

Eigen::Matrix3d about(double deg, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(rad_from_deg(deg), axis.normalized()).toRotationMatrix();
}

/// A tablet that lies on its reverse, its top edge away from the operator: the faces along the axes.
std::string said(const Eigen::Matrix3d& turn, const Eigen::Matrix3d& frame_from_model) {
  return say_turn(turn, frame_from_model, kUp, ModelFaces{});
}
std::string said(const Eigen::Matrix3d& turn) {
  return said(turn, Eigen::Matrix3d::Identity());
}

/// Where a named face or corner looks, level.
std::optional<Eigen::Vector3d> way_of(const std::string& name, const Eigen::Matrix3d& frame_from_model) {
  Eigen::Vector3d way = Eigen::Vector3d::Zero();
  for (const Face face :
       {Face::kObverse, Face::kReverse, Face::kLeft, Face::kRight, Face::kTop, Face::kBottom}) {
    if (name.find(spoken(face)) != std::string::npos) {
      const Eigen::Vector3d normal = frame_from_model * ModelFaces{}.normal(face);
      way += (normal - kUp * normal.dot(kUp)).normalized();
    }
  }
  return way.norm() < 0.5 ? std::nullopt : std::optional<Eigen::Vector3d>(way.normalized());
}

/// The turn that hands make which have nothing but the words.
std::optional<Eigen::Matrix3d> made_of(const std::string& words, const Eigen::Matrix3d& frame_from_model) {
  static const std::regex kTip(
      "turn (?:it so that )?(.*?) (?:comes )?towards the camera, ([0-9]+)°(?:, by way of (.*?))?"
      "(?:, and turn it where it lies, ([0-9]+)° (counter-)?clockwise seen from the camera)?");
  static const std::regex kAbout(
      "turn the tablet where it lies, ([0-9]+)° (counter-)?clockwise seen from the camera");
  std::smatch part;
  if (std::regex_match(words, part, kAbout)) {
    return about((part[2].matched ? 1 : -1) * std::stod(part[1]), kUp);
  }
  if (words == "leave the tablet as it lies") {
    return Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  }
  if (!std::regex_match(words, part, kTip)) {
    return std::nullopt;
  }
  const auto way = way_of(part[3].matched ? part[3] : part[1], frame_from_model);
  if (!way) {
    return std::nullopt;
  }
  Eigen::Matrix3d turn = about(std::stod(part[2]), way->cross(kUp));
  if (part[4].matched) {
    turn = about((part[5].matched ? 1 : -1) * std::stod(part[4]), kUp) * turn;
  }
  return turn;
}

double apart_deg(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return deg_from_rad(Eigen::AngleAxisd(a.transpose() * b).angle());
}

TEST(TurnWords, SayWhatComesHowFarAndByWhichWay) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  EXPECT_EQ(said(about(1, x)), "leave the tablet as it lies");
  EXPECT_EQ(said(about(-40, kUp)), "turn the tablet where it lies, 40° clockwise seen from the camera");
  EXPECT_EQ(said(about(40, x)), "turn the top edge towards the camera, 40°");
  EXPECT_EQ(said(about(-90, y)), "turn the right edge towards the camera, 90°");
  EXPECT_EQ(
      said(about(40, x - y)),
      "turn it so that the corner between the right edge and the top edge comes towards the camera, 40°");
  EXPECT_EQ(said(about(150, x)), "turn the reverse towards the camera, 150°, by way of the top edge");
  EXPECT_EQ(
      said(about(150, x + y)),
      "turn the reverse towards the camera, 150°, by way of the corner between the left edge and the top "
      "edge");
  // Turned over, either way round does: the simplest words.
  EXPECT_EQ(said(about(180, y)), "turn the reverse towards the camera, 180°, by way of the left edge");
  EXPECT_EQ(said(about(180, x)), "turn the reverse towards the camera, 180°, by way of the top edge");
  EXPECT_EQ(
      said(about(60, kUp) * about(-90, y)),
      "turn the right edge towards the camera, 90°, and turn it where it lies, 60° counter-clockwise seen "
      "from the camera");
}

TEST(TurnWords, HandsThatHaveNothingElseMakeTheTurn) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 4000; ++k) {
    const Eigen::Matrix3d turn =
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
            .normalized()
            .toRotationMatrix();
    // As it lies on any of its sides, a little askew.
    const Eigen::Matrix3d lies =
        about(90.0 * (k % 4), kUp) *
        about(90.0 * (k / 4 % 4), k / 16 % 2 == 0 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY()) *
        about(8, Eigen::Vector3d(normal(random), normal(random), normal(random)));
    const std::string words = said(turn, lies);
    const auto made = made_of(words, lies);
    ASSERT_TRUE(made) << words;
    // The way is told to half a corner, of a tablet that lies askew a little more. Where it goes nearly all
    // the way over that turns it about the line of sight by twice as much; the line of sight itself is off by
    // less.
    EXPECT_LT(apart_deg(turn, *made), 54) << words;
    EXPECT_LT(
        deg_from_rad(std::acos(std::clamp((turn.transpose() * kUp).dot(made->transpose() * kUp), -1.0, 1.0))),
        26)
        << words;
  }
}

}  // namespace
}  // namespace dubsar
