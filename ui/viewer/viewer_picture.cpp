// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Pictures that are kept: to scale, at any resolution, drawn and written while the window goes on.
#include <chrono>
#include <cmath>

#include "archive/scale_bar.h"
#include "station/picture_file.h"
#include "ui/gl/gl_window.h"
#include "ui/viewer/viewer_screen.h"

namespace dubsar::ui {

namespace {

constexpr double kMmPerInch = 25.4;
/// As many pixels as a picture is given: 1.2 GB, and what packing it takes.
constexpr double kMostMegapixels = 400;

}  // namespace

/// To scale: the whole surface as it is turned now, a margin and a bar, so many pixels to the inch.
void ViewerScreen::begin_picture(const UiContext& ui) {
  OrbitCamera camera = camera_;
  camera.fit(prepared_.shown().box_mm, 1.0F);
  Eigen::AlignedBox3f eye;
  for (int k = 0; k < 8; ++k) {
    eye.extend(camera.eye_from_model *
               (prepared_.shown().box_mm.corner(static_cast<Eigen::AlignedBox3f::CornerType>(k)) -
                camera.centre_mm));
  }
  const double mm_per_px = kMmPerInch / dpi_;
  const Eigen::Vector2f mm = 1.06F * eye.sizes().head<2>() + Eigen::Vector2f(2, 8);
  const double width = std::ceil(mm.x() / mm_per_px);
  const double height = std::ceil(mm.y() / mm_per_px);
  picture_kept_ = false;
  if (width * height > 1e6 * kMostMegapixels) {
    picture_note_ = filled(ui.text(Text::kPictureTooLarge), width, height, kMostMegapixels);
    return;
  }
  camera.half_height_mm = static_cast<float>(0.5 * height * mm_per_px);
  Look look = look_;
  look.ground = {0, 0, 0, 1};
  picture_note_.clear();
  still_mm_per_px_ = mm_per_px;
  still_file_ = unused_file(fmt::format("{}dpi", dpi_), {".png"});
  still_.emplace(camera, look, static_cast<int>(width), static_cast<int>(height));
}

void ViewerScreen::give_up_picture() {
  if (still_) {
    still_.reset();
    surface_.end_still();
    handed_out_.erase(still_file_);
  }
}

void ViewerScreen::draw_picture_on(UiContext& ui) {
  if (still_) {
    const TimedWork timed(ui.watch, "a picture to scale");
    unfinished_ = true;
    if (!still_->draw_on(surface_)) {
      Image picture = still_->take();
      still_.reset();
      picture.mm_per_px = still_mm_per_px_;
      writing_ = std::async(std::launch::async, [picture = std::move(picture), file = still_file_]() mutable {
        const ScaleBar bar = scale_bar_for(picture.mm_per_px, picture.width);
        const int margin = static_cast<int>(1.0 / picture.mm_per_px);
        dubsar::draw_scale_bar(picture, bar, margin, picture.height - bar.height_px - margin,
                               {255, 255, 255});
        Status written = write_picture(file, picture, {.title = file.stem().string()});
        wake_window();
        return written;
      });
    }
  }
  if (writing_.valid() && writing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    const Status written = writing_.get();
    picture_kept_ = written.has_value();
    picture_note_ = written ? filled(ui.text(Text::kPictureKept), still_file_.string())
                            : translated(written.error(), ui.preferences.language);
  }
  if (picture_kept_) {
    ui.facts.insert("picture-kept");
  }
}

/// The button, and how far the picture is, with its end.
void ViewerScreen::draw_picture_foot(UiContext& ui) {
  const bool busy = still_ || writing_.valid();
  if (busy) {
    ImGui::PushFont(ui.fonts.small);
    if (plain_button(ui, "stop-picture", ui.text(Text::kStop), still_.has_value())) {
      give_up_picture();
    }
    ImGui::SameLine();
    job_bar(ui, picture_time_left_, ui.text(Text::kPicture), still_ ? still_->fraction() : 1.0);
    ImGui::PopFont();
  }
  if (plain_button(ui, "keep-picture", ui.text(Text::kPicture), is_current() && !busy)) {
    begin_picture(ui);
  }
  ImGui::SameLine();
  ImGui::SetNextItemWidth(ui.px(3));
  ImGui::InputInt(ui.text(Text::kDpi), &dpi_, 0);
  ui.target("dpi");
  dpi_ = std::clamp(dpi_, 50, 2400);
}

}  // namespace dubsar::ui
