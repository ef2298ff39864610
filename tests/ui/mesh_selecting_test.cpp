// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Selection on the graphics card against the same worked out by hand, far beyond 2^16 faces.

#include "ui/view/mesh_selecting.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/support/raster_mesh.h"
#include "tests/ui/support/on_a_window.h"

namespace dubsar::ui {
namespace {

constexpr int kWidth = 400;
constexpr int kHeight = 300;

/// Two sheets, one behind the other, seen from +z: 2 × 2 n² faces.
Mesh two_sheets(std::uint32_t n, float apart_mm = 5) {
  Mesh mesh;
  for (std::uint32_t sheet = 0; sheet < 2; ++sheet) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::uint32_t y = 0; y <= n; ++y) {
      for (std::uint32_t x = 0; x <= n; ++x) {
        mesh.positions.emplace_back(static_cast<float>(x) * 40 / static_cast<float>(n),
                                    static_cast<float>(y) * 30 / static_cast<float>(n),
                                    sheet == 0 ? 0.0F : -apart_mm);
      }
    }
    test::add_raster_faces(mesh, first, n);
  }
  return mesh;
}

class Selecting : public OnAWindow {
 protected:
  void show() override {
    shown_ = shown_mesh(two_sheets(301));  // 362 thousand faces, in no whole number of words
    view_->show(shown_);
    camera_.fit(shown_.box_mm, static_cast<float>(kWidth) / kHeight);
    view_->draw_whole(camera_, {}, kWidth, kHeight);
  }
  /// Where the middle of a face stands in the picture.
  [[nodiscard]] Eigen::Vector2f middle_of(std::size_t f) const {
    const auto& [a, b, c] = shown_.faces[f];
    const Eigen::Vector3f middle = (shown_.positions[a] + shown_.positions[b] + shown_.positions[c]) / 3;
    return camera_.pixel_of(middle, {kWidth, kHeight});
  }
  [[nodiscard]] bool in_front(std::size_t f) const { return shown_.positions[shown_.faces[f][0]].z() > -1; }

  /// To its end.
  bool select(MeshElement of, const std::vector<Eigen::Vector2f>& corners, SelectionStep step, bool through) {
    const bool can = view_->select(of, corners, step, through);
    while (view_->select_more()) {
    }
    return can;
  }
  [[nodiscard]] BitMarks marks_now() const { return *view_->selection()->selected(); }

  ShownMesh shown_;
  OrbitCamera camera_;
};

/// A rectangle between these pixels.
std::vector<Eigen::Vector2f> box(float x1, float y1, float x2, float y2) {
  return {{x1, y1}, {x2, y1}, {x2, y2}, {x1, y2}};
}

TEST_F(Selecting, WhatAPolygonHoldsAndNothingElse) {
  ASSERT_TRUE(select(MeshElement::kFace, box(100, 80, 220, 200), SelectionStep::kUnion, true));
  const BitMarks selected = marks_now();
  ASSERT_EQ(selected.size(), shown_.faces.size());
  std::size_t wrong = 0;
  std::size_t inside = 0;
  std::size_t last = 0;
  for (std::size_t f = 0; f < selected.size(); ++f) {
    const Eigen::Vector2f at = middle_of(f);
    const bool near_border = std::min({std::abs(at.x() - 100), std::abs(at.x() - 220), std::abs(at.y() - 80),
                                       std::abs(at.y() - 200)}) < 1;
    const bool within = at.x() > 100 && at.x() < 220 && at.y() > 80 && at.y() < 200;
    inside += within ? 1 : 0;
    last = selected[f] ? f : last;
    wrong += !near_border && within != (selected[f]) ? 1 : 0;
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_GT(inside, 40000U);
  EXPECT_GT(last, std::size_t{1} << 17U) << "faces beyond 2^16 take part";
}

TEST_F(Selecting, PicturesAndSelectionsCountAsGraphicsMemory) {
  constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;
  const std::size_t before = view_->graphics_bytes();
  EXPECT_GT(before, view_->buffers()->bytes() + 20 * kPixels) << "lit, shaded and deep";
  ASSERT_TRUE(select(MeshElement::kFace, box(100, 80, 220, 200), SelectionStep::kUnion, true));
  EXPECT_GE(view_->graphics_bytes(), before + shown_.faces.size() / 4) << "a bit each, before and now";
  view_->clear_selection();
  EXPECT_EQ(view_->graphics_bytes(), before);
}

TEST_F(Selecting, OnlyWhatIsSeen) {
  ASSERT_TRUE(select(MeshElement::kFace, box(50, 50, 350, 250), SelectionStep::kUnion, false));
  const BitMarks selected = marks_now();
  std::size_t front = 0;
  std::size_t back = 0;
  for (std::size_t f = 0; f < selected.size(); ++f) {
    (in_front(f) ? front : back) += selected[f] ? 1 : 0;
  }
  EXPECT_GT(front, std::size_t{60000});
  EXPECT_EQ(back, 0U);
}

/// A slab's side wall belongs to the picture's rim alone, however little the view is turned.
TEST_F(Selecting, AWallThatIsSeenEdgeOnIsNot) {
  constexpr float kHighMm = 9;
  constexpr std::uint32_t kN = 301;
  const auto of_wall = [&](float leaning_deg) {
    Mesh mesh = two_sheets(kN);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const std::size_t faces = mesh.faces.size();
    const float out_mm = kHighMm * std::tan(leaning_deg * 0.0174533F);
    for (std::uint32_t down = 0; down <= kN; ++down) {
      const float part = static_cast<float>(kN - down) / kN;  // the lowest first: the faces look outwards
      for (std::uint32_t x = 0; x <= kN; ++x) {
        mesh.positions.emplace_back(40 - static_cast<float>(x) * 40 / kN, 30 + part * out_mm,
                                    -part * kHighMm);
      }
    }
    test::add_raster_faces(mesh, first, kN);
    for (std::size_t f = faces; f < mesh.faces.size(); ++f) {
      const auto& [a, b, c] = mesh.faces[f];
      const Eigen::Vector3f& at = mesh.positions[a];
      if ((mesh.positions[b] - at).cross(mesh.positions[c] - at).z() < 0) {
        std::swap(mesh.faces[f][1], mesh.faces[f][2]);
      }
    }
    shown_ = shown_mesh(mesh);
    view_->show(shown_);
    camera_.fit(shown_.box_mm, static_cast<float>(kWidth) / kHeight);
    view_->draw_whole(camera_, {}, kWidth, kHeight);
    EXPECT_TRUE(
        select(MeshElement::kFace, box(-1, -1, kWidth + 1, kHeight + 1), SelectionStep::kUnion, false));
    const BitMarks marks = marks_now();
    view_->clear_selection();
    std::array<std::size_t, 3> sums{};  // of the wall, of the front, of the wall in all
    for (std::size_t f = 0; f < shown_.faces.size(); ++f) {
      const bool wall = shown_.face_of[f] >= faces;
      sums[wall ? 0 : 1] += marks[f] && (wall || in_front(f)) ? 1 : 0;
      sums[2] += wall ? 1 : 0;
    }
    return sums;
  };
  for (const float leaning_deg : {0.04F, 0.5F, 1.5F}) {
    const auto [wall, front, all] = of_wall(leaning_deg);
    EXPECT_EQ(wall, 0U) << leaning_deg;
    EXPECT_EQ(front, std::size_t{2} * kN * kN) << leaning_deg;
  }
  const auto [wall, front, all] = of_wall(20);
  EXPECT_EQ(all, std::size_t{2} * kN * kN);
  EXPECT_GT(static_cast<double>(wall), 0.95 * static_cast<double>(all)) << "a slope is seen";
}

TEST_F(Selecting, WhatIsHiddenCloseBehindIsNotSeenAndASlopeIs) {
  constexpr float kApartMm = 0.15F;
  shown_ = shown_mesh(two_sheets(301, kApartMm));
  view_->show(shown_);
  const auto front_and_back = [&] {
    view_->draw_whole(camera_, {}, kWidth, kHeight);
    EXPECT_TRUE(
        select(MeshElement::kFace, box(-1, -1, kWidth + 1, kHeight + 1), SelectionStep::kUnion, false));
    const BitMarks marks = marks_now();
    std::array<std::size_t, 2> sums{};
    for (std::size_t f = 0; f < shown_.faces.size(); ++f) {
      const bool front = shown_.positions[shown_.faces[f][0]].z() > -kApartMm / 2;
      sums[front ? 0 : 1] += marks[f] ? 1 : 0;
    }
    view_->clear_selection();
    return sums;
  };
  const std::size_t all = shown_.faces.size() / 2;
  EXPECT_EQ(front_and_back(), (std::array<std::size_t, 2>{all, 0}));
  camera_.eye_from_model = Eigen::AngleAxisf(1.1F, Eigen::Vector3f::UnitX());  // 63 degrees
  const auto [front, back] = front_and_back();
  EXPECT_EQ(front, all);
  const float high_px = 30 * std::cos(1.1F) / camera_.mm_per_px(kHeight);
  const float wide_px = 40 / camera_.mm_per_px(kHeight);
  EXPECT_LT(static_cast<float>(back) / static_cast<float>(all), 4 / high_px + 4 / wide_px)
      << "but for two pixels of its rim, more than one of which stands out";
}

TEST_F(Selecting, PolygonsGoTogetherAsAsked) {
  const auto count = [&] { return static_cast<double>(marks_now().marked()); };
  ASSERT_TRUE(select(MeshElement::kFace, box(100, 100, 200, 200), SelectionStep::kUnion, true));
  const double one = count();
  view_->draw_whole(camera_, {}, kWidth, kHeight);
  ASSERT_TRUE(select(MeshElement::kFace, box(150, 100, 250, 200), SelectionStep::kUnion, true));
  EXPECT_NEAR(count(), 1.5 * one, 0.03 * one);
  ASSERT_TRUE(select(MeshElement::kFace, box(100, 100, 200, 200), SelectionStep::kIntersection, true));
  EXPECT_NEAR(count(), one, 0.03 * one);
  ASSERT_TRUE(select(MeshElement::kFace, box(100, 100, 150, 200), SelectionStep::kDifference, true));
  EXPECT_NEAR(count(), 0.5 * one, 0.03 * one);
  // The picture tells the selected apart.
  view_->draw_whole(camera_, {}, kWidth, kHeight);
  const Image picture = view_->read();
  const Rgb8 in = picture.rgb(175, 150);
  const Rgb8 out = picture.rgb(125, 150);
  EXPECT_GT(in[2], in[0]);
  EXPECT_LT(out[2], out[0]);
  EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST_F(Selecting, PointsOfTheSurfaceAndOfACloud) {
  const auto inside_box = [&](std::size_t v) {
    const Eigen::Vector2f at = camera_.pixel_of(shown_.positions[v], {kWidth, kHeight});
    return at.x() > 100.5F && at.x() < 219.5F && at.y() > 80.5F && at.y() < 199.5F;
  };
  const auto count_missing = [&](bool through) {
    const BitMarks selected = marks_now();
    EXPECT_EQ(selected.size(), shown_.positions.size());
    std::size_t missing = 0;
    std::size_t outside = 0;
    for (std::size_t v = 0; v < selected.size(); ++v) {
      const bool wanted = inside_box(v) && (through || shown_.positions[v].z() > -1);
      missing += wanted && !selected[v] ? 1 : 0;
      const Eigen::Vector2f at = camera_.pixel_of(shown_.positions[v], {kWidth, kHeight});
      const bool far = at.x() < 99 || at.x() > 221 || at.y() < 79 || at.y() > 201;
      outside += selected[v] && (far || (!through && shown_.positions[v].z() < -1)) ? 1 : 0;
    }
    EXPECT_EQ(outside, 0U);
    return missing;
  };
  ASSERT_TRUE(select(MeshElement::kVertex, box(100, 80, 220, 200), SelectionStep::kUnion, false));
  EXPECT_EQ(count_missing(false), 0U);
  view_->draw_whole(camera_, {}, kWidth, kHeight);
  const Image picture = view_->read();
  EXPECT_GT(picture.rgb(160, 140)[2], picture.rgb(160, 140)[0]) << "told apart in the picture";
  EXPECT_LT(picture.rgb(300, 140)[2], picture.rgb(300, 140)[0]);
  ASSERT_TRUE(select(MeshElement::kVertex, box(100, 80, 220, 200), SelectionStep::kUnion, true));
  EXPECT_EQ(count_missing(true), 0U);
  // The other kind begins anew.
  ASSERT_TRUE(select(MeshElement::kFace, box(0, 0, 10, 10), SelectionStep::kUnion, true));
  EXPECT_EQ(view_->selection()->of(), MeshElement::kFace);

  Mesh cloud = two_sheets(60);
  cloud.faces.clear();
  shown_ = shown_mesh(cloud);
  view_->show(shown_);
  view_->draw_whole(camera_, {}, kWidth, kHeight);
  EXPECT_FALSE(select(MeshElement::kFace, box(100, 80, 220, 200), SelectionStep::kUnion, true));
  ASSERT_TRUE(select(MeshElement::kVertex, box(100, 80, 220, 200), SelectionStep::kUnion, true));
  EXPECT_EQ(count_missing(true), 0U);
  EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST_F(Selecting, AHandMayTurnItBeforeThePolygonIsThrough) {
  const std::vector<Eigen::Vector2f> corners = box(50, 50, 250, 250);
  ASSERT_TRUE(select(MeshElement::kFace, corners, SelectionStep::kUnion, false));
  const BitMarks at_rest = marks_now();
  view_->clear_selection();
  ASSERT_TRUE(view_->select(MeshElement::kFace, corners, SelectionStep::kUnion, false));
  int pieces = 0;
  while (view_->select_more()) {
    ++pieces;
    EXPECT_EQ(view_->selection()->selected(), nullptr) << "nothing is shown by halves";
    camera_.drag({0, 0}, {0.3F, 0.2F});
    view_->draw_whole(camera_, {}, kWidth / 2, kHeight);
  }
  EXPECT_GT(pieces, 1);
  EXPECT_EQ(marks_now(), at_rest);
  EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST_F(Selecting, EveryLevelOfDetailShowsWhatIsSelected) {
  ASSERT_EQ(view_->levels(), 2U);
  const std::vector<Eigen::Vector2f> left = box(60, 50, 190, 250);
  ASSERT_TRUE(select(MeshElement::kFace, left, SelectionStep::kUnion, true));
  const BitMarks selected = marks_now();
  const auto blue_of = [&](std::size_t level) {
    view_->draw_level(level, camera_, {}, kWidth, kHeight);
    const Image picture = view_->read();
    std::vector<bool> blue;
    for (std::size_t i = 0; i + 2 < picture.bytes.size(); i += 4) {
      blue.push_back(picture.bytes[i + 2] > picture.bytes[i] + 20);
    }
    return blue;
  };
  const std::vector<bool> fine = blue_of(1);
  const std::vector<bool> coarse = blue_of(0);
  const auto inside = static_cast<double>(std::ranges::count(fine, true));
  EXPECT_NEAR(inside, 130 * 200, 130 * 200 * 0.02);
  std::size_t other = 0;
  for (std::size_t i = 0; i < fine.size(); ++i) {
    other += fine[i] != coarse[i] ? 1 : 0;
  }
  EXPECT_LT(static_cast<double>(other), 0.03 * inside) << "but for the rim";
  EXPECT_EQ(marks_now(), selected) << "what is selected is of the whole surface";
}

TEST_F(Selecting, ASelectionThatWasKeptIsShownAgain) {
  BitMarks marks(shown_.faces.size());
  for (std::size_t f = 0; f < marks.size(); f += 3) {
    marks.mark(f);
  }
  view_->set_selection(MeshElement::kFace, std::make_shared<const BitMarks>(marks));
  EXPECT_EQ(marks_now(), marks);
  // And goes on from there.
  view_->draw_whole(camera_, {}, kWidth, kHeight);
  ASSERT_TRUE(select(MeshElement::kFace, box(0, 0, kWidth, kHeight), SelectionStep::kUnion, true));
  EXPECT_NE(marks.size() % 1024, 0U) << "the last words are not full";
  EXPECT_EQ(marks_now().marked(), marks.size());
}

TEST(PolygonMask, EvenOddAndBottomRowFirst) {
  const std::vector<std::uint8_t> mask = polygon_mask({{1, 1}, {9, 1}, {9, 9}, {1, 9}}, 10, 12);
  EXPECT_EQ(mask[static_cast<std::size_t>(12 - 1 - 5) * 10 + 5], 255);
  EXPECT_EQ(mask[static_cast<std::size_t>(12 - 1 - 10) * 10 + 5], 0);
  EXPECT_EQ(mask[static_cast<std::size_t>(12 - 1 - 5) * 10 + 0], 0);
  std::size_t inside = 0;
  for (const std::uint8_t one : mask) {
    inside += one / 255U;
  }
  EXPECT_EQ(inside, 64U);
  EXPECT_EQ(polygon_mask({{-50, -50}, {50, -50}, {50, 50}, {-50, 50}}, 3, 3),
            std::vector<std::uint8_t>(9, 255));
}

decltype(epoxy_glGetIntegerv) real_get_integer = nullptr;

/// A driver that lets shaders look up as few as OpenGL allows.
void least_allowed(GLenum what, GLint* value) {
  if (what == GL_MAX_TEXTURE_BUFFER_SIZE) {
    *value = 65536;
  } else {
    real_get_integer(what, value);
  }
}

TEST_F(Selecting, MoreFacesThanTheDriverCanNumberAreNotSelectedWrongly) {
  EXPECT_TRUE(view_->can_select(MeshElement::kFace));
  real_get_integer = epoxy_glGetIntegerv;
  epoxy_glGetIntegerv = least_allowed;
  const bool can = view_->can_select(MeshElement::kFace);
  const bool did = view_->select(MeshElement::kFace, {{0, 0}, {kWidth, 0}, {kWidth, kHeight}},
                                 SelectionStep::kUnion, true);
  view_->set_selection(MeshElement::kFace, std::make_shared<const BitMarks>(shown_.faces.size()));
  const bool marked = view_->selection() != nullptr;
  epoxy_glGetIntegerv = real_get_integer;
  EXPECT_FALSE(can);
  EXPECT_FALSE(did);
  EXPECT_FALSE(marked);
}

}  // namespace
}  // namespace dubsar::ui
