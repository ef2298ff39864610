// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The pictures of a package, all drawn from the model on the CPU and all to scale.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "archive/fatcross.h"
#include "archive/jpeg.h"
#include "archive/png.h"
#include "archive/rollout.h"
#include "archive/scale_bar.h"
#include "archive/tiff.h"
#include "core/parallel.h"
#include "formats/atomic_file.h"
#include "station/package_content.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;
constexpr double kMmPerInch = 25.4;
constexpr std::array<int, 3> kFatcrossDpi = {300, 600, 1000};
/// Of the six views and the rollout: 42 µm to a pixel.
constexpr int kViewDpi = 600;

/// Looks of the six views, in the order that render_looks() draws them.
struct NamedLook {
  const char* name;
  const char* label;
  Look look;
};

/// Integral invariants as grey, valleys dark: those of a wedge are near 0.4, a hair of noise is 0.02.
std::vector<float> invariant_tone(const std::vector<float>& invariants) {
  constexpr float kMiddle = 0.62F;
  constexpr float kPerUnit = 1.1F;
  std::vector<float> tone(invariants.size());
  parallel_for_each_index(
      tone.size(), [&](std::size_t v) { tone[v] = kMiddle - kPerUnit * invariants[v]; }, 1U << 14U);
  return tone;
}

/// Ambient occlusion as grey, a little darker than it is, so that shallow signs show.
std::vector<float> openness_tone(const std::vector<float>& openness) {
  constexpr float kGamma = 1.5F;
  std::vector<float> tone(openness.size());
  parallel_for_each_index(
      tone.size(), [&](std::size_t v) { tone[v] = std::pow(std::max(0.0F, openness[v]), kGamma); },
      1U << 14U);
  return tone;
}

/// A file that is written beside others: encoding takes longer than drawing.
struct Task {
  std::string path;
  std::function<Result<std::vector<std::uint8_t>>()> encode;
};

Status write_all(const PackageContent& content, const std::vector<Task>& tasks) {
  std::vector<std::optional<Error>> failed(tasks.size());
  parallel_for_each_index(
      tasks.size(),
      [&](std::size_t k) {
        if (content.job.cancelled()) {
          failed[k] = Error{ErrorKind::kCancelled, "stopped", {}, {}};
          return;
        }
        const auto place = content.place(tasks[k].path);
        if (!place) {
          failed[k] = place.error();
          return;
        }
        const auto bytes = tasks[k].encode();
        if (!bytes) {
          failed[k] = bytes.error();
        } else if (const Status written =
                       write_file_atomically(*place, std::as_bytes(std::span(bytes->data(), bytes->size())));
                   !written) {
          failed[k] = written.error();
        }
      },
      1);
  for (const std::optional<Error>& error : failed) {
    if (error) {
      return std::unexpected(*error);
    }
  }
  return {};
}

class Drawing {
 public:
  explicit Drawing(PackageContent& content) : content_(content), scene_(content.mesh()) {}

  /// Where the sides fit into pictures at kViewDpi; else says that they do not.
  Status views();
  Status fatcrosses();
  Status rollout();

 private:
  /// Whether every side fits into a picture at kViewDpi.
  [[nodiscard]] Result<bool> have_room() const;
  [[nodiscard]] Rgb8 ground() const { return content_.options.white_ground ? kPaper : kBlackGround; }
  [[nodiscard]] RenderOptions options(int dpi) const {
    RenderOptions options;
    options.mm_per_px = kMmPerInch / dpi;
    options.margin_px = 0;
    options.background = ground();
    return options;
  }
  void list(const std::string& path, const std::string& label, const char* media_type, const Image& image,
            std::vector<WedgeOnPicture> wedges = {}) {
    content_.pictures.push_back(
        {path, label, media_type, image.width, image.height, image.mm_per_px, std::move(wedges)});
  }
  /// Those that a side's views at kViewDpi show.
  [[nodiscard]] Result<std::vector<WedgeOnPicture>> wedges_on(Face face) const;
  [[nodiscard]] std::vector<WedgeOnPicture> wedges_on_fatcross(FatcrossKind kind) const;
  [[nodiscard]] PictureWords words(const std::string& what) const {
    return picture_words(content_.label, content_.identifier + ", " + what);
  }

  PackageContent& content_;
  RenderScene scene_;
  SixViews clay_;                                                 ///< at kViewDpi, for the fatcross
  bool has_views_ = false;                                        ///< clay_ is drawn
  std::array<std::vector<WedgeOnPicture>, kFaceCount> wedges_{};  ///< on them, by Face
};

Result<bool> Drawing::have_room() const {
  for (const Face face : kSixViewOrder) {
    const Result<Framing> framing =
        framing_of(scene_, face_camera(face, content_.tablet_from_model), options(kViewDpi));
    if (!framing && framing.error().kind == ErrorKind::kUsage) {
      return false;
    }
    if (!framing) {
      return std::unexpected(framing.error());
    }
  }
  return true;
}

Result<std::vector<WedgeOnPicture>> Drawing::wedges_on(Face face) const {
  if (!content_.wedges || content_.wedges->wedges.empty()) {
    return std::vector<WedgeOnPicture>();
  }
  const ViewCamera camera = face_camera(face, content_.tablet_from_model);
  const Result<Framing> framing = framing_of(scene_, camera, options(kViewDpi));
  return framing ? wedges_in_view(content_.wedges->wedges, scene_, camera, *framing)
                 : Result<std::vector<WedgeOnPicture>>(std::unexpected(framing.error()));
}

std::vector<WedgeOnPicture> Drawing::wedges_on_fatcross(FatcrossKind kind) const {
  const auto corners = fatcross_corners(clay_, kind);
  std::vector<WedgeOnPicture> all;
  for (const Face face : kSixViewOrder) {
    for (WedgeOnPicture on : wedges_[static_cast<std::size_t>(face)]) {
      for (Eigen::Vector2d& corner : on.corners_px) {
        corner += corners[static_cast<std::size_t>(face)].cast<double>();
      }
      on.view = face;
      all.push_back(on);
    }
  }
  return all;
}

Status Drawing::views() {
  const Result<bool> room = have_room();
  if (!room) {
    return std::unexpected(room.error());
  }
  if (!*room) {
    content_.lacking.push_back(fmt::format(
        "Pictures of the six sides: the tablet is too large for them at {} dots per inch.", kViewDpi));
    return {};
  }
  if (const Status had = content_.need_fields(); !had) {
    return had;
  }
  const std::vector<float> invariants = invariant_tone(content_.fields->invariants);
  const std::vector<float> openness = openness_tone(content_.fields->openness);
  const std::array<NamedLook, 4> looks = {
      {{"clay", "clay", {RenderStyle::kClay, Lighting::kRaking, {}}},
       {"msii", "integral invariants", {RenderStyle::kTone, Lighting::kFlat, invariants}},
       {"ao", "ambient occlusion", {RenderStyle::kTone, Lighting::kFlat, openness}},
       {"radiance", "radiance scaling", {RenderStyle::kClay, Lighting::kRadiance, {}}}}};
  std::array<Look, looks.size()> plain{};
  std::ranges::transform(looks, plain.begin(), &NamedLook::look);
  std::array<std::vector<PackagedPicture>, looks.size()> listed;
  int done = 0;
  for (const Face face : kSixViewOrder) {
    content_.job.progress("drawing views", static_cast<double>(done++) / kFaceCount);
    Result<std::vector<Image>> images = render_looks(scene_, face_camera(face, content_.tablet_from_model),
                                                     options(kViewDpi), plain, content_.job);
    if (!images) {
      return std::unexpected(images.error());
    }
    Result<std::vector<WedgeOnPicture>> wedges = wedges_on(face);
    if (!wedges) {
      return std::unexpected(wedges.error());
    }
    std::vector<Task> tasks;
    std::array<Image, looks.size()> ruled;  // the fatcross has a ruler of its own
    for (std::size_t k = 0; k < looks.size(); ++k) {
      ruled[k] = with_scale_bar((*images)[k], ground());
      const Image& image = ruled[k];
      const std::string path = fmt::format("pictures/{}/{}.png", looks[k].name, view_file_stem(face));
      const std::string label = fmt::format("{}, {}", to_string(face), looks[k].label);
      tasks.push_back({path, [&image, said = words(label)] { return encode_png(image, said); }});
      listed[k].push_back({path, label, "image/png", image.width, image.height, image.mm_per_px, *wedges});
    }
    tasks.push_back({fmt::format("pictures/cdli/{}_{}.jpg", content_.stem, cdli_suffix(face)),
                     [&clay = ruled.front(), said = words(fmt::format("{}, clay", to_string(face)))] {
                       return encode_jpeg(clay, said);
                     }});
    if (const Status written = write_all(content_, tasks); !written) {
      return written;
    }
    clay_.of[static_cast<std::size_t>(face)] = std::move(images->front());
    wedges_[static_cast<std::size_t>(face)] = std::move(*wedges);
  }
  has_views_ = true;
  for (std::size_t k = 0; k < looks.size(); ++k) {
    content_.pictures.insert(content_.pictures.end(), listed[k].begin(), listed[k].end());
    content_.list(
        fmt::format("pictures/{}/", looks[k].name),
        fmt::format("the six sides, {}, {} pixels to the inch of the tablet, below each a scale bar",
                    looks[k].label, kViewDpi));
  }
  content_.list(
      "pictures/cdli/",
      "the six sides in clay once more, as JPEG with the endings of CDLI: o obverse, r reverse, le left "
      "edge, re right edge, te top edge, be bottom edge");
  return {};
}

Status Drawing::fatcrosses() {
  struct Kind {
    FatcrossKind kind;
    const char* name;
    const char* label;
  };
  constexpr std::array<Kind, 2> kKinds = {
      {{FatcrossKind::kCdli, "cdli", "fatcross (CDLI)"}, {FatcrossKind::kEbl, "ebl", "fatcross (eBL)"}}};
  int done = 0;
  bool any = false;
  for (const int dpi : kFatcrossDpi) {
    content_.job.progress("drawing fatcrosses", static_cast<double>(done++) / kFatcrossDpi.size());
    SixViews own;
    const bool is_drawn = dpi == kViewDpi && has_views_;
    if (!is_drawn) {
      SixViewOptions six;
      six.render = options(dpi);
      six.tablet_from_model = content_.tablet_from_model;
      Result<SixViews> drawn = render_six_views(scene_, six, content_.job);
      if (!drawn && drawn.error().kind == ErrorKind::kUsage) {
        content_.lacking.push_back(fmt::format(
            "Fatcross at {} dots per inch: the tablet is too large for a picture of that scale.", dpi));
        continue;
      }
      if (!drawn) {
        return std::unexpected(drawn.error());
      }
      own = std::move(*drawn);
    }
    any = true;
    const SixViews& views = is_drawn ? clay_ : own;
    std::array<Image, kKinds.size()> sheets;
    std::vector<Task> tasks;
    for (std::size_t k = 0; k < kKinds.size(); ++k) {
      sheets[k] = fatcross(views, kKinds[k].kind, ground());
      const std::string stem =
          fmt::format("pictures/fatcross/{}_{}_{}dpi", content_.stem, kKinds[k].name, dpi);
      const Image& sheet = sheets[k];
      const PictureWords said = words(fmt::format("{}, {} dpi, to scale", kKinds[k].label, dpi));
      tasks.push_back({stem + ".tif", [&sheet, said] { return encode_tiff(sheet, said, program_name()); }});
      tasks.push_back({stem + ".jpg", [&sheet, said] { return encode_jpeg(sheet, said); }});
      if (is_drawn) {
        list(stem + ".jpg", kKinds[k].label, "image/jpeg", sheet, wedges_on_fatcross(kKinds[k].kind));
      }
    }
    if (const Status written = write_all(content_, tasks); !written) {
      return written;
    }
  }
  if (any) {
    content_.list(
        "pictures/fatcross/",
        "all six sides on one picture, to scale throughout: as CDLI and as eBL lay them out, at 300, 600 "
        "and 1000 pixels to the inch of the tablet, TIFF and JPEG");
  }
  return {};
}

Status Drawing::rollout() {
  constexpr const char* kTooLarge = "Rollout: the tablet is too large for a picture of that scale.";
  if (!has_views_) {  // it is larger than any of them, and to unroll what is so large takes long
    content_.lacking.emplace_back(kTooLarge);
    return {};
  }
  content_.job.progress("drawing the rollout", 0.0);
  const Result<Image> image =
      rollout_picture(scene_, content_.tablet_from_model, options(kViewDpi), content_.job);
  if (!image && image.error().kind == ErrorKind::kUsage) {
    content_.lacking.emplace_back(kTooLarge);
    return {};
  }
  if (!image) {
    return std::unexpected(image.error());
  }
  const std::string path = "pictures/" + content_.stem + "_rollout.png";
  if (const Status written =
          write_all(content_, {{path, [&] { return encode_png(*image, words("rollout")); }}});
      !written) {
    return written;
  }
  list(path, "Rollout", "image/png", *image);
  content_.list(
      path,
      "the tablet unrolled along its side, from the obverse over the bottom edge to the reverse "
      "and the top edge: a tick at the right where each begins, a scale bar below; clay that would be "
      "drawn more than three times as long as it is, as in a broken corner, is left out");
  return {};
}

}  // namespace

Status add_renderings(PackageContent& content) {
  if (content.mesh().faces.empty()) {
    content.lacking.emplace_back("There are no pictures: there is no model to draw.");
    return {};
  }
  Drawing drawing(content);
  if (const Status drawn = drawing.views(); !drawn) {
    return drawn;
  }
  if (const Status drawn = drawing.fatcrosses(); !drawn) {
    return drawn;
  }
  return drawing.rollout();
}

}  // namespace dubsar
