// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/report_pictures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "archive/glyphs.h"
#include "archive/png.h"
#include "archive/region_picture.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

constexpr Rgb8 kNumberInk{20, 60, 200};
constexpr int kNumberScale = 4;  ///< still legible on the page, where the sheet is half as wide

double size_of(const RedRegion& region) {
  return std::isfinite(region.area_mm2) ? region.area_mm2 : 0.0;
}

/// On clay that is as dark as the ink, digits need an edge of light.
void draw_on_paper(Image& image, int x, int y, const std::string& number) {
  constexpr int kEdge = 3;
  for (const auto& [dx, dy] : {std::pair{-kEdge, 0},
                               {kEdge, 0},
                               {0, -kEdge},
                               {0, kEdge},
                               {-kEdge, -kEdge},
                               {kEdge, -kEdge},
                               {-kEdge, kEdge},
                               {kEdge, kEdge}}) {
    draw_text(image, x + dx, y + dy, number, kPaper, kNumberScale);
  }
  draw_text(image, x, y, number, kNumberInk, kNumberScale);
}

/// Right of a ring, or left of it; in it where it is wider than the picture.
Eigen::AlignedBox2i box_of_number(const Image& image, double x, double y, double radius_px, int wide,
                                  int high) {
  double left = x + radius_px + 4;
  if (left + wide >= image.width) {
    left = x - radius_px - 4 - wide;
  }
  if (left < 0) {
    left = x - 0.5 * wide;
  }
  const int most_left = std::max(0, image.width - wide);
  const int most_top = std::max(0, image.height - high);
  const Eigen::Vector2i at(std::clamp(static_cast<int>(left), 0, most_left),
                           std::clamp(static_cast<int>(y) - high / 2, 0, most_top));
  return {at, at + Eigen::Vector2i(wide, high)};
}

/// Rings and numbers on the side that each place belongs to.
Status number_places(const ReportInput& input, const std::vector<RegionPicture>& places,
                     const RenderScene& scene, const RenderOptions& drawn_with, SixViews& views) {
  for (const Face face : kSixViewOrder) {
    Image& image = views.of[static_cast<std::size_t>(face)];
    RenderOptions options = drawn_with;
    options.mm_per_px = image.mm_per_px;
    const ViewCamera camera = face_camera(face, input.tablet_from_model);
    const Result<Framing> framing = framing_of(scene, camera, options);
    if (!framing) {
      return std::unexpected(framing.error());
    }
    std::vector<Eigen::AlignedBox2i> taken;
    for (const RegionPicture& place : places) {
      const RedRegion& region = input.red_map.regions[place.region];
      if (place.side != face) {
        continue;
      }
      const Eigen::Vector3d p = camera.view_from_model * region.center_mm;
      const double x = (p.x() - framing->left_mm) / framing->mm_per_px;
      const double y = (framing->top_mm - p.y()) / framing->mm_per_px;
      const double radius_px = std::max(9.0, 0.7 * std::sqrt(size_of(region)) / framing->mm_per_px);
      draw_ring(image, x, y, radius_px, 7.0, kPaper);
      draw_ring(image, x, y, radius_px, 3.0, kNumberInk);
      const std::string number = std::to_string(region_number(place.region));
      const int wide = text_width(number, kNumberScale);
      const int high = kGlyphHeight * kNumberScale;
      Eigen::AlignedBox2i box = box_of_number(image, x, y, radius_px, wide, high);
      while (std::ranges::any_of(taken, [&](const Eigen::AlignedBox2i& other) {
        return other.intersects(box);
      })) {  // places close together: their numbers stand in a column
        box.translate(Eigen::Vector2i(0, high / 2));
      }
      taken.push_back(box);
      draw_on_paper(image, box.min().x(), box.min().y(), number);
    }
  }
  return {};
}

/// The pictures of the pages as data URIs; packing takes longer than drawing, so all at once. Their titles
/// leave to the page which tablet it is: that may be put right later.
Status encode(ReportPictures& pictures) {
  std::vector<std::optional<Error>> failed(pictures.regions.size() + 1);
  parallel_for_each_index(
      failed.size(),
      [&](std::size_t k) {
        const bool sheet = k == pictures.regions.size();
        const Image& image = sheet ? pictures.red_page : pictures.regions[k].image;
        Result<std::string> uri = png_data_uri(
            image, sheet ? "red map" : "place " + std::to_string(region_number(pictures.regions[k].region)));
        if (uri) {
          (sheet ? pictures.red_page_uri : pictures.regions[k].uri) = std::move(*uri);
        } else {
          failed[k] = uri.error();
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

}  // namespace

std::vector<std::size_t> regions_by_weight(const RedMap& map) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < map.regions.size(); ++k) {
    if (!is_stray(map.regions[k])) {
      order.push_back(k);
    }
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const RedRegion& one = map.regions[a];
    const RedRegion& other = map.regions[b];
    return one.state != other.state ? one.state == RegionState::kRed : size_of(one) > size_of(other);
  });
  return order;
}

Image halved(const Image& image) {
  Image out = filled_image(image.width / 2, image.height / 2, kPaper, image.channels);
  out.mm_per_px = 2 * image.mm_per_px;
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      for (std::size_t k = 0; k < static_cast<std::size_t>(image.channels); ++k) {
        const int sum = image.bytes[image.offset(2 * x, 2 * y) + k] +
                        image.bytes[image.offset(2 * x + 1, 2 * y) + k] +
                        image.bytes[image.offset(2 * x, 2 * y + 1) + k] +
                        image.bytes[image.offset(2 * x + 1, 2 * y + 1) + k];
        out.bytes[out.offset(x, y) + k] = static_cast<std::uint8_t>((sum + 2) / 4);
      }
    }
  }
  return out;
}

Result<ReportPictures> draw_pictures(const ReportInput& input, const JobContext& job) {
  ReportPictures out;
  const RenderScene bare(input.model);
  constexpr int kBarTextScale = 4;  // the page shows the sheet half as large
  if (bare.empty()) {
    return out;
  }
  out.empty = false;
  SixViewOptions options;
  options.tablet_from_model = input.tablet_from_model;
  options.render.longest_px = input.longest_px;
  options.bar_text_scale = kBarTextScale;
  Result<SixViews> sides = render_six_views(bare, options, job);
  if (!sides) {
    return std::unexpected(sides.error());
  }
  out.sides = std::move(*sides);
  out.sides_sheet = six_view_sheet(out.sides, options);

  for (const std::size_t k : regions_by_weight(input.red_map)) {
    if (out.regions.size() == kMostRegionPictures) {
      break;
    }
    const RedRegion& region = input.red_map.regions[k];
    const Eigen::Vector3d towards = outlook(input.model, region);
    Result<Image> image =
        region_picture(input.model, input.red_points, region, towards, input.tablet_from_model, job);
    if (!image) {
      return std::unexpected(image.error());
    }
    out.regions.push_back({k, region.face, std::move(*image), {}});
  }

  const RenderScene marked(input.model, &input.red_points);
  options.render.style = RenderStyle::kRedMap;
  Result<SixViews> red = render_six_views(marked, options, job);
  if (!red) {
    return std::unexpected(red.error());
  }
  if (const Status numbered = number_places(input, out.regions, marked, options.render, *red); !numbered) {
    return std::unexpected(numbered.error());
  }
  out.red_sheet = six_view_sheet(*red, options);
  out.red_page = halved(out.red_sheet);
  if (const Status encoded = encode(out); !encoded) {
    return std::unexpected(encoded.error());
  }
  return out;
}

}  // namespace dubsar
