// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/wedge_annotations.h"

#include <fmt/format.h>

#include <cmath>

#include "archive/rights.h"
#include "core/units.h"
#include "core/wedge_length.h"
#include "formats/json_text.h"

namespace dubsar {

namespace {

/// A closed ring: the first corner comes again at the end.
std::string polygon_z(const Wedge& wedge) {
  std::string text = "POLYGON Z ((";
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector3d& p = wedge.outer_vertices_mm[k % 3];
    text += fmt::format("{}{:.4f} {:.4f} {:.4f}", k == 0 ? "" : ", ", p.x(), p.y(), p.z());
  }
  return text + "))";
}

}  // namespace

std::string wedge_in_words(const Wedge& w) {
  const auto directional = static_cast<std::size_t>(w.directional_edge);
  std::string where = w.place.side ? std::string(" on the ") + to_string(*w.place.side) : "";
  if (w.place.side && w.place.line > 0) {
    where += fmt::format(", line {}, number {}", w.place.line, w.place.order);
  }
  // A picture may show the side as it lies on the tablet: the left edge upright.
  const std::string turn =
      w.place.side ? fmt::format(" at {:.0f} degrees as the side is read",
                                 std::round(deg_from_rad(w.place.turn_rad)) + 0.0)  // nought has no sign
                   : std::string();
  return fmt::format(
      "Wedge {}{}: {:.2f} mm deep, directional edge {:.2f} mm long{}{}, confidence {:.2f}{}", w.id, where,
      w.depth_mm, w.edge_lengths_mm[directional],
      length_is_guess(w, directional) ? " (the mesh ends before it: not measured)" : "", turn, w.confidence,
      w.by_hand == ByHand::kNo
          ? std::string()
          : fmt::format("; corrected by hand: {}", kByHandNames[static_cast<std::size_t>(w.by_hand)]));
}

std::string label_of_wedges(const AnnotationSource& source) {
  return (source.simulated.empty() ? "" : "SIMULATED. ") + ("Wedges of " + source.identifier) +
         (source.simulated.empty() ? "" : ". " + source.simulated);
}

std::string wedge_annotations(const std::vector<Wedge>& wedges, const AnnotationSource& source) {
  const OrderedJson generator = {{"type", "Software"}, {"name", source.program}};
  OrderedJson items = OrderedJson::array();
  for (const Wedge& wedge : wedges) {
    const std::string id = fmt::format("{}{}#wedge-{}", source.base_url, source.page, wedge.id);
    OrderedJson bodies =
        OrderedJson::array({{{"type", "TextualBody"},
                             {"purpose", "describing"},
                             {"format", "text/plain"},
                             {"language", "en"},
                             {"value", wedge_in_words(wedge)}},
                            {{"type", "TextualBody"}, {"purpose", "tagging"}, {"value", "wedge"}}});
    items.push_back({{"id", id},
                     {"type", "Annotation"},
                     {"motivation", "describing"},
                     {"created", source.when},
                     {"generator", generator},
                     {"body", std::move(bodies)},
                     {"target",
                      {{"type", "SpecificResource"},
                       {"source", source.base_url + source.model},
                       {"selector", {{"type", "WktSelector"}, {"value", polygon_z(wedge)}}}}}});
  }
  // The selector is not among those of 2017: its terms are told here, so that it stays valid JSON-LD.
  const OrderedJson terms = {{"WktSelector", "http://www.opengis.net/ont/geosparql#wktLiteral"}};
  OrderedJson page = {{"@context", OrderedJson::array({"http://www.w3.org/ns/anno.jsonld", terms})},
                      {"id", source.base_url + source.page},
                      {"type", "AnnotationPage"},
                      {"label", label_of_wedges(source)}};
  if (const std::string rights = rights_address(source.rights); !rights.empty()) {
    page["rights"] = rights;
  }
  page["items"] = std::move(items);
  return text_of(page);
}

}  // namespace dubsar
