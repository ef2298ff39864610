// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Pictures that are kept: to scale, at any resolution, drawn and written while the window goes on.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>

#include "archive/scale_bar.h"
#include "station/picture_file.h"
#include "ui/gl/gl_window.h"
#include "ui/viewer/viewer_screen.h"

namespace dubsar::ui {

namespace {

constexpr double kMmPerInch = 25.4;
/// As many pixels as a picture is given: 1.2 GB, and what packing it takes.
constexpr double kMostMegapixels = 400;
/// As high as a legend may be to stay above the surface.
constexpr double kLegendMm = 2.8;

Text word_of(MeshField field) {
  switch (field) {
    case MeshField::kOpenness:
      return Text::kOverlayOpenness;
    case MeshField::kMeanCurvature:
      return Text::kOverlayCurvature;
    case MeshField::kHeight:
      return Text::kOverlayHeight;
    case MeshField::kInvariant:
      return Text::kOverlayMsii;
    case MeshField::kSigma:
      return Text::kOverlaySigma;
  }
  return Text::kOverlay;
}

Rgb8 rgb_of(const Eigen::Vector3f& colour) {
  const auto part = [&](int k) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(colour[k], 0.0F, 1.0F)));
  };
  return {part(0), part(1), part(2)};
}

}  // namespace

std::optional<ColourLegend> ViewerScreen::picture_legend() const {
  // In English, as the files have it: the letters of pictures are ASCII.
  const auto word = [](Text text) { return std::string(text_of(text, Language::kEnglish)); };
  ColourLegend legend;
  if (look_.overlay == Overlay::kFlags) {
    legend.name = word(Text::kOverlayFlags);
    legend.marks = {{word(Text::kSparse), rgb_of(look_.red)}, {word(Text::kFilledIn), rgb_of(look_.amber)}};
    return legend;
  }
  if (look_.overlay == Overlay::kValue && field_) {
    legend.name = word(word_of(*field_));
    legend.low = static_cast<double>(look_.value_range.x());
    legend.high = static_cast<double>(look_.value_range.y());
  } else if (look_.overlay == Overlay::kReliability || look_.overlay == Overlay::kScans) {
    const bool scans = look_.overlay == Overlay::kScans;
    legend.name = word(scans ? Text::kOverlayScans : Text::kOverlayReliability);
    legend.high = scans ? 8 : 1;
  } else {
    return std::nullopt;
  }
  const auto colours = overlay_colours();
  legend.colours.assign(colours.begin(), colours.end());
  return legend;
}

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
  still_legend_ = picture_legend();
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
      writing_ = std::async(std::launch::async, [picture = std::move(picture), file = still_file_,
                                                 legend = still_legend_]() mutable {
        const ScaleBar bar = scale_bar_for(picture.mm_per_px, picture.width);
        const int margin = static_cast<int>(1.0 / picture.mm_per_px);
        dubsar::draw_scale_bar(picture, bar, margin, picture.height - bar.height_px - margin,
                               {255, 255, 255});
        if (legend) {
          const int rows = static_cast<int>(kLegendMm / picture.mm_per_px);
          draw_colour_legend(picture, *legend, margin, margin, std::min(bar.text_scale, rows / kLegendRows),
                             {255, 255, 255});
        }
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
