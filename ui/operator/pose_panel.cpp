// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/pose_panel.h"

#include <cmath>

namespace dubsar::ui {

namespace {

constexpr float kLookDownRad = 0.6F;
constexpr double kPeriodS = 2.5;

/// The operator stands at the stage's -y and looks a little down on it.
Eigen::Matrix3f eye_from_stage() {
  Eigen::Matrix3f m;
  const float c = std::cos(kLookDownRad);
  const float s = std::sin(kLookDownRad);
  m << 1, 0, 0,  //
      0, s, c,   //
      0, -c, s;
  return m;
}

void arrow_head(ImDrawList* draw, ImVec2 tip, ImVec2 from, float size, ImU32 colour) {
  const float dx = tip.x - from.x;
  const float dy = tip.y - from.y;
  const float length = std::max(1e-3F, std::sqrt(dx * dx + dy * dy));
  const ImVec2 along{dx / length * size, dy / length * size};
  draw->AddTriangleFilled({tip.x + along.x, tip.y + along.y},
                          {tip.x - along.y * 0.7F, tip.y + along.x * 0.7F},
                          {tip.x + along.y * 0.7F, tip.y - along.x * 0.7F}, colour);
}

}  // namespace

TurnToMake turn_to_make(const NextView& next) {
  TurnToMake out;
  const Placement placement = next.placement.value_or(Placement{});
  const Eigen::Matrix3d stage_from_model_then =
      stage_from_scanner(placement, Eigen::Vector3d::Zero()).rotation *
      next.model_from_scanner.rotation.transpose();
  Eigen::Matrix3d now = stage_from_model_then;
  if (placement.hand_turn) {
    now = placement.hand_turn->rotation.transpose() * stage_from_model_then;
    out.by_hand = true;
  }
  out.stage_from_model_then = stage_from_model_then.cast<float>();
  out.stage_from_model_now = now.cast<float>();
  return out;
}

void PosePanel::show(const ShownMesh& shown) {
  box_mm_ = shown.box_mm;
  now_.show(shown);
  then_.show(shown);
}

bool PosePanel::draw(UiContext& ui, const NextView& next, ImVec2 size) {
  const ImVec2 origin = ImGui::GetCursorScreenPos();
  ImDrawList* draw = ImGui::GetWindowDrawList();
  ImGui::Dummy(size);
  ui.target("pose");
  if (now_.empty() || box_mm_.isEmpty() || size.x < 20 || size.y < 20) {
    return false;
  }
  const TurnToMake turn = turn_to_make(next);
  const int width = static_cast<int>(size.x);
  const int height = static_cast<int>(size.y);
  const float aspect = size.x / size.y;
  OrbitCamera camera;
  camera.centre_mm = box_mm_.center();
  camera.depth_mm = box_mm_.diagonal().norm();
  const float radius = 0.5F * box_mm_.diagonal().norm();
  camera.half_height_mm = 1.12F * radius / std::min(1.0F, aspect);
  const Eigen::Matrix3f look = eye_from_stage();
  Look plain;
  plain.occlusion = false;
  plain.radiance = 0;
  const ImVec2 end{origin.x + size.x, origin.y + size.y};
  const auto put = [&](SurfaceView& view, const Eigen::Matrix3f& stage_from_model, const Look& how,
                       float alpha) {
    camera.eye_from_model = Eigen::Quaternionf(Eigen::Matrix3f(look * stage_from_model)).normalized();
    view.draw(camera, how, width, height);
    draw->AddImage(picture_of(view.texture()), origin, end, {0, 1}, {1, 0},
                   ImGui::ColorConvertFloat4ToU32({1, 1, 1, alpha}));
  };
  // A point of the stage about the tablet's middle, in the picture.
  const auto pixel = [&](const Eigen::Vector3f& at_mm) {
    const Eigen::Vector3f eye = look * at_mm;
    const float scale = size.y / (2 * camera.half_height_mm);
    return ImVec2{origin.x + 0.5F * size.x + eye.x() * scale, origin.y + 0.5F * size.y - eye.y() * scale};
  };
  put(now_, turn.stage_from_model_now, plain, 1.0F);
  const ImU32 ink = packed(ui.colours.ghost);
  const float head = ui.px(0.75F);
  if (!turn.by_hand) {
    const Placement placement = next.placement.value_or(Placement{});
    const Eigen::Vector3f towards =
        stage_from_scanner(placement, Eigen::Vector3d::Zero()).rotation.col(2).cast<float>();
    const ImVec2 from = pixel(1.1F * radius * towards);
    const ImVec2 to = pixel(0.45F * radius * towards);
    draw->AddLine(from, to, ink, 0.35F * head);
    arrow_head(draw, to, from, head, ink);
    return false;
  }
  Look ghost = plain;
  ghost.clay = ui.colours.ghost.head<3>();
  const Eigen::AngleAxisf whole(
      Eigen::Matrix3f(turn.stage_from_model_then * turn.stage_from_model_now.transpose()));
  // The ghost turns from how it lies to how it is to lie, and rests there.
  const double phase = ui.still ? 1.0 : std::fmod(ui.time_s, kPeriodS) / kPeriodS;
  const float part = static_cast<float>(std::min(1.0, 1.6 * phase));
  const Eigen::AngleAxisf so_far(part * whole.angle(), whole.axis());
  put(then_, so_far.toRotationMatrix() * turn.stage_from_model_now, ghost, 0.55F);
  // Along the turn, around its axis, where the operator's hand goes.
  Eigen::Vector3f start =
      Eigen::Vector3f(0, -0.45F, 0.9F) - whole.axis() * whole.axis().dot(Eigen::Vector3f(0, -0.45F, 0.9F));
  if (start.norm() < 0.2F) {
    start = whole.axis().unitOrthogonal();
  }
  start = start.normalized() * 0.95F * radius;
  const float reach = std::min(whole.angle(), 2.6F);
  ImVec2 last{};
  ImVec2 before{};
  constexpr int kPieces = 24;
  for (int k = 0; k <= kPieces; ++k) {
    const float angle = (static_cast<float>(k) / kPieces - 0.5F) * reach;
    before = last;
    last = pixel(Eigen::AngleAxisf(angle, whole.axis()) * start);
    if (k > 0) {
      draw->AddLine(before, last, ink, 0.35F * head);
    }
  }
  arrow_head(draw, last, before, head, ink);
  return !ui.still;
}

}  // namespace dubsar::ui
