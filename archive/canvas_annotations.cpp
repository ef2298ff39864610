// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/canvas_annotations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "archive/rights.h"
#include "formats/json_text.h"

namespace dubsar {

namespace {

/// The smallest rectangle of whole pixels round the triangle, as far as it lies on the canvas.
std::string fragment(const WedgeOnPicture& on, const AnnotatedCanvas& canvas) {
  const auto [least_x, most_x] =
      std::minmax({on.corners_px[0].x(), on.corners_px[1].x(), on.corners_px[2].x()});
  const auto [least_y, most_y] =
      std::minmax({on.corners_px[0].y(), on.corners_px[1].y(), on.corners_px[2].y()});
  const auto span = [](double least, double most, int size) {
    const int from = std::clamp(static_cast<int>(std::floor(least)), 0, std::max(0, size - 1));
    return std::pair(
        from, std::clamp(static_cast<int>(std::ceil(most)), from + 1, std::max(from + 1, size)) - from);
  };
  const auto [x, wide] = span(least_x, most_x, canvas.width);
  const auto [y, high] = span(least_y, most_y, canvas.height);
  return fmt::format("xywh={},{},{},{}", x, y, wide, high);
}

/// Of a page no two are the same: a wedge is at most once in a view.
std::string annotation_id(const Wedge& wedge, const WedgeOnPicture& on, const AnnotationSource& source) {
  const std::string side = on.view ? fmt::format("-{}", to_string(*on.view)) : std::string();
  return fmt::format("{}{}#wedge-{}{}", source.base_url, source.page, wedge.id, side);
}

std::string triangle(const WedgeOnPicture& on) {
  const auto& [a, b, c] = on.corners_px;
  return fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg"><path d="M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z"/></svg>)",
      a.x(), a.y(), b.x(), b.y(), c.x(), c.y());
}

}  // namespace

std::string canvas_annotations(const std::vector<Wedge>& wedges, const std::vector<WedgeOnPicture>& shown,
                               const AnnotatedCanvas& canvas, const AnnotationSource& source) {
  const OrderedJson generator = {{"type", "Software"}, {"name", source.program}};
  OrderedJson items = OrderedJson::array();
  for (const WedgeOnPicture& on : shown) {
    const Wedge& wedge = wedges.at(on.wedge);
    OrderedJson selectors = OrderedJson::array({{{"type", "FragmentSelector"},
                                                 {"conformsTo", "http://www.w3.org/TR/media-frags/"},
                                                 {"value", fragment(on, canvas)}},
                                                {{"type", "SvgSelector"}, {"value", triangle(on)}}});
    items.push_back({{"id", annotation_id(wedge, on, source)},
                     {"type", "Annotation"},
                     {"motivation", "commenting"},
                     {"created", source.when},
                     {"generator", generator},
                     {"body",
                      {{"type", "TextualBody"},
                       {"format", "text/plain"},
                       {"language", "en"},
                       {"value", wedge_in_words(wedge)}}},
                     {"target",
                      {{"type", "SpecificResource"},
                       {"source", {{"id", canvas.id}, {"type", "Canvas"}}},
                       {"selector", std::move(selectors)}}}});
  }
  OrderedJson page = {{"@context", "http://iiif.io/api/presentation/3/context.json"},
                      {"id", source.base_url + source.page},
                      {"type", "AnnotationPage"},
                      {"label", {{"en", OrderedJson::array({label_of_wedges(source)})}}}};
  if (const std::string rights = iiif_rights(source.rights); !rights.empty()) {
    page["rights"] = rights;
  }
  if (!source.rights.empty()) {
    page["requiredStatement"] = {{"label", {{"en", OrderedJson::array({"Rights"})}}},
                                 {"value", {{"none", OrderedJson::array({source.rights})}}}};
  }
  page["items"] = std::move(items);
  return text_of(page);
}

}  // namespace dubsar
