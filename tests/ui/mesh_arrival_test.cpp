// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Meshes on their way to the graphics card: piece by piece, and where it has no room for them.

#include "ui/view/mesh_arrival.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <cmath>
#include <thread>
#include <utility>

#include "tests/support/raster_mesh.h"
#include "tests/ui/support/on_a_window.h"

namespace dubsar::ui {
namespace {

constexpr int kWidth = 240;
constexpr int kHeight = 180;

/// A wavy square of 2 cells² faces, `side_mm` wide.
Mesh waves(std::uint32_t cells, float side_mm) {
  Mesh mesh;
  const float mm = side_mm / static_cast<float>(cells);
  for (std::uint32_t y = 0; y <= cells; ++y) {
    for (std::uint32_t x = 0; x <= cells; ++x) {
      const Eigen::Vector2f at = mm * Eigen::Vector2f(static_cast<float>(x), static_cast<float>(y));
      mesh.positions.emplace_back(at.x(), at.y(), std::sin(at.x()) * std::cos(at.y()));
    }
  }
  test::add_raster_faces(mesh, 0, cells);
  return mesh;
}

// A card that gives no buffer larger than this.
std::size_t largest_buffer = 0;
bool has_refused = false;
decltype(epoxy_glBufferData) real_buffer_data = nullptr;
decltype(epoxy_glGetError) real_get_error = nullptr;

void small_buffer_data(GLenum target, GLsizeiptr bytes, const void* data, GLenum usage) {
  if (static_cast<std::size_t>(bytes) > largest_buffer) {
    has_refused = true;
  } else {
    real_buffer_data(target, bytes, data, usage);
  }
}

GLenum small_get_error() {
  return std::exchange(has_refused, false) ? static_cast<GLenum>(GL_OUT_OF_MEMORY) : real_get_error();
}

/// As long as it stands.
class SmallCard {
 public:
  explicit SmallCard(std::size_t largest) {
    // Looked up by their first call, which else would come back to those that stand in for them.
    glBufferData(GL_ARRAY_BUFFER, 0, nullptr, GL_STATIC_DRAW);
    static_cast<void>(glGetError());
    real_buffer_data = epoxy_glBufferData;
    real_get_error = epoxy_glGetError;
    largest_buffer = largest;
    epoxy_glBufferData = small_buffer_data;
    epoxy_glGetError = small_get_error;
  }
  ~SmallCard() {
    epoxy_glBufferData = real_buffer_data;
    epoxy_glGetError = real_get_error;
  }
  SmallCard(const SmallCard&) = delete;
  SmallCard& operator=(const SmallCard&) = delete;
};

class Arriving : public OnAWindow {
 protected:
  void show() override {
    mesh_ = waves(900, 20);  // 1.6 million faces
    whole_ = std::make_shared<ShownMesh>(shown_mesh(mesh_));
    ASSERT_EQ(whole_->coarser.size(), 2U);
    camera_.fit(whole_->box_mm, static_cast<float>(kWidth) / kHeight);
  }
  std::shared_ptr<ShownMesh> arrive() {
    MeshArrival arrival;
    arrival.begin(whole_);
    while (true) {
      if (std::shared_ptr<ShownMesh> shown = arrival.go_on(*view_)) {
        EXPECT_FALSE(arrival.is_under_way());
        return shown;
      }
      EXPECT_TRUE(arrival.is_under_way());
      std::this_thread::yield();
    }
  }
  std::vector<unsigned char> drawn() {
    view_->draw_whole(camera_, look_, kWidth, kHeight);
    return view_->read().bytes;
  }
  [[nodiscard]] static double unlike(const std::vector<unsigned char>& a,
                                     const std::vector<unsigned char>& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      sum += std::abs(int{a[k]} - int{b[k]});
    }
    return sum / static_cast<double>(a.size());
  }

  Mesh mesh_;
  std::shared_ptr<ShownMesh> whole_;
  OrbitCamera camera_;
  Look look_;
};

TEST_F(Arriving, WhatWasShownStaysUntilAllIsThere) {
  view_->show(shown_mesh(waves(100, 20)));
  const auto before = drawn();
  MeshArrival arrival;
  arrival.begin(whole_);
  int pieces = 0;
  while (!arrival.go_on(*view_)) {
    ++pieces;
    ASSERT_EQ(drawn(), before);
  }
  EXPECT_GT(pieces, 1);
  const auto in_pieces = drawn();
  EXPECT_NE(in_pieces, before);
  view_->show(*whole_);
  EXPECT_EQ(drawn(), in_pieces);
}

TEST_F(Arriving, ACardWithoutRoomShowsACoarserLevel) {
  look_.overlay = Overlay::kValue;
  look_.value_range = {-1, 1};
  std::vector<float> heights;
  for (const Eigen::Vector3f& p : mesh_.positions) {
    heights.push_back(p.z());
  }
  view_->show(*whole_);
  view_->set_values(heights);
  const auto wanted = drawn();
  for (const std::size_t level : {1U, 0U}) {
    const std::size_t faces = whole_->coarser[level].detail.faces.size();
    const SmallCard card(faces * 18);  // room for its faces and for a third more
    const std::shared_ptr<ShownMesh> shown = arrive();
    EXPECT_EQ(shown->faces.size(), faces);
    EXPECT_EQ(shown->coarser.size(), level);
    EXPECT_EQ(shown->instead_of_faces, whole_->faces.size());
    view_->set_values(of_shown(*shown, heights));
    EXPECT_LT(unlike(drawn(), wanted), 3) << "level " << level;
    for (std::size_t coarser = 0; coarser < level; ++coarser) {
      view_->draw_level(coarser, camera_, look_, kWidth, kHeight);
      EXPECT_LT(unlike(view_->read().bytes, wanted), 3);
    }
    EXPECT_FALSE(view_->can_select(MeshElement::kFace)) << "numbers of faces would be those of others";
    EXPECT_FALSE(view_->select(MeshElement::kFace, {{0, 0}, {kWidth, 0}, {kWidth, kHeight}},
                               SelectionStep::kUnion, true));
  }
  EXPECT_EQ(arrive(), whole_) << "once there is room";
  EXPECT_TRUE(view_->can_select(MeshElement::kFace));
  EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST_F(Arriving, ACardWithoutAnyRoomShowsNothing) {
  {
    const SmallCard card(1000);
    EXPECT_TRUE(arrive()->coarser.empty());
    EXPECT_TRUE(view_->empty());
    constexpr int kMost = 10;
    int pictures = 0;
    while (view_->draw(camera_, look_, kWidth, kHeight) && pictures < kMost) {
      ++pictures;
    }
    EXPECT_LT(pictures, kMost) << "it comes to rest";
  }
  EXPECT_EQ(arrive(), whole_);
}

TEST_F(Arriving, ACardWithoutRoomToSelectSaysSo) {
  view_->show(*whole_);
  drawn();
  const std::vector<Eigen::Vector2f> corners{{0, 0}, {kWidth, 0}, {kWidth, kHeight}};
  {
    const SmallCard card(1000);
    EXPECT_FALSE(view_->select(MeshElement::kFace, corners, SelectionStep::kUnion, true));
  }
  EXPECT_FALSE(view_->can_select(MeshElement::kFace));
  EXPECT_EQ(view_->selection(), nullptr);
  view_->show(*whole_);
  drawn();
  EXPECT_TRUE(view_->select(MeshElement::kFace, corners, SelectionStep::kUnion, true));
}

}  // namespace
}  // namespace dubsar::ui
