// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/iiif_manifest.h"

#include "archive/rights.h"
#include "formats/json_text.h"

namespace dubsar {

namespace {

OrderedJson words(const char* language, const std::string& text) {
  return {{language, OrderedJson::array({text})}};
}

OrderedJson links(const std::string& base_url, const std::vector<ManifestLink>& all) {
  OrderedJson list = OrderedJson::array();
  for (const ManifestLink& link : all) {
    list.push_back({{"id", base_url + link.path},
                    {"type", link.type},
                    {"label", words("en", link.label)},
                    {"format", link.media_type}});
  }
  return list;
}

OrderedJson canvas(const std::string& base_url, const ManifestPicture& picture, const std::string& id) {
  const OrderedJson body = {{"id", base_url + picture.path},
                            {"type", "Image"},
                            {"format", picture.media_type},
                            {"width", picture.width},
                            {"height", picture.height}};
  const OrderedJson painting = {{"id", id + "/painting"},
                                {"type", "Annotation"},
                                {"motivation", "painting"},
                                {"body", body},
                                {"target", id}};
  OrderedJson json = {
      {"id", id},
      {"type", "Canvas"},
      {"label", words("en", picture.label)},
      {"width", picture.width},
      {"height", picture.height},
      {"items",
       OrderedJson::array(
           {{{"id", id + "/page"}, {"type", "AnnotationPage"}, {"items", OrderedJson::array({painting})}}})}};
  if (!picture.annotations.empty()) {
    json["annotations"] =
        OrderedJson::array({{{"id", base_url + picture.annotations}, {"type", "AnnotationPage"}}});
  }
  if (picture.mm_per_px > 0) {
    constexpr double kCmPerMm = 0.1;
    json["service"] =
        OrderedJson::array({{{"@context", "http://iiif.io/api/annex/services/physdim/1/context.json"},
                             {"id", id + "/scale"},
                             {"type", "PhysicalDimensions"},
                             {"profile", "http://iiif.io/api/annex/services/physdim"},
                             {"physicalScale", kCmPerMm * picture.mm_per_px},
                             {"physicalUnits", "cm"}}});
  }
  return json;
}

}  // namespace

std::string canvas_id(const std::string& base_url, std::size_t picture) {
  return base_url + "iiif/canvas/" + std::to_string(picture + 1);
}

std::string iiif_manifest(const ManifestInput& input) {
  OrderedJson json = {{"@context", "http://iiif.io/api/presentation/3/context.json"},
                      {"id", input.base_url + "iiif/manifest.json"},
                      {"type", "Manifest"},
                      {"label", words("none", input.label)},
                      {"summary", words("en", input.summary)}};
  OrderedJson metadata = OrderedJson::array();
  for (const auto& [label, value] : input.metadata) {
    if (!value.empty()) {
      metadata.push_back({{"label", words("en", label)}, {"value", words("none", value)}});
    }
  }
  if (!metadata.empty()) {
    json["metadata"] = std::move(metadata);
  }
  if (!input.rights.empty()) {
    if (const std::string address = iiif_rights(input.rights); !address.empty()) {
      json["rights"] = address;
    }
    json["requiredStatement"] = {{"label", words("en", "Rights")}, {"value", words("none", input.rights)}};
  }
  if (!input.rendering.empty()) {
    json["rendering"] = links(input.base_url, input.rendering);
  }
  if (!input.see_also.empty()) {
    json["seeAlso"] = links(input.base_url, input.see_also);
  }
  json["items"] = OrderedJson::array();
  for (std::size_t i = 0; i < input.pictures.size(); ++i) {
    json["items"].push_back(canvas(input.base_url, input.pictures[i], canvas_id(input.base_url, i)));
  }
  return text_of(json);
}

}  // namespace dubsar
