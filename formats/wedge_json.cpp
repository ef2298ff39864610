// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/wedge_json.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/units.h"

namespace dubsar {

namespace {

using Three = std::array<double, 3>;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr Three kThreeUnknown = {kUnknown, kUnknown, kUnknown};

bool is_known(double value) {
  return std::isfinite(value);
}
bool are_known(const Three& values) {
  return std::ranges::all_of(values, is_known);
}

const std::vector<std::string> kDirectionalBy(kDirectionalByNames.begin(), kDirectionalByNames.end());

OrderedJson degrees_json(const Three& angles_rad) {
  OrderedJson json = OrderedJson::array();
  for (const double angle_rad : angles_rad) {
    json.push_back(deg_from_rad(angle_rad));
  }
  return json;
}

OrderedJson points_json(const std::array<Eigen::Vector3d, 3>& points) {
  OrderedJson json = OrderedJson::array();
  for (const Eigen::Vector3d& point : points) {
    json.push_back(json_of(point));
  }
  return json;
}

/// The three entries of an array; noted and empty when there are others.
std::vector<JsonNode> three(const JsonNode& node) {
  std::vector<JsonNode> nodes = node.items();
  if (nodes.size() != 3) {
    node.complain("has " + std::to_string(nodes.size()) + " entries, not 3");
    nodes.clear();
  }
  return nodes;
}

Three radians_from(const JsonNode& node) {
  const std::vector<double> deg = node.numbers(3);
  return {rad_from_deg(deg[0]), rad_from_deg(deg[1]), rad_from_deg(deg[2])};
}

Three lengths_from(const JsonNode& node, double mm) {
  const std::vector<double> values = node.numbers(3);
  return {mm * values[0], mm * values[1], mm * values[2]};
}

std::array<Eigen::Vector3d, 3> points_from(const JsonNode& node, double mm) {
  std::array<Eigen::Vector3d, 3> points = three_zeros();
  const std::vector<JsonNode> nodes = three(node);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    points[k] = mm * nodes[k].vector3();
  }
  return points;
}

/// Keys of what is not known are left out.
OrderedJson sigma_json(const WedgeSigma& sigma) {
  OrderedJson json;
  const auto add_degrees = [&json](const char* key, const Three& angles_rad) {
    if (are_known(angles_rad)) {
      json[key] = degrees_json(angles_rad);
    }
  };
  json["depth_point"] = sigma.depth_point_mm;
  json["depth"] = sigma.depth_mm;
  if (std::ranges::any_of(sigma.length_mm, is_known)) {
    json["edge_lengths"] = sigma.length_mm;  // null of one that is not known: the others are
  }
  add_degrees("edges_deg", sigma.edge_rad);
  add_degrees("edge_slopes_deg", sigma.edge_slope_rad);
  add_degrees("opening_angles_deg", sigma.opening_rad);
  add_degrees("face_angles_deg", sigma.face_angle_rad);
  add_degrees("face_slopes_deg", sigma.face_slope_rad);
  if (is_known(sigma.volume_mm3)) {
    json["volume_mm3"] = sigma.volume_mm3;
  }
  return json;
}

WedgeSigma unknown_sigma() {
  return {.depth_point_mm = kUnknown,
          .depth_mm = kUnknown,
          .edge_rad = kThreeUnknown,
          .edge_slope_rad = kThreeUnknown,
          .opening_rad = kThreeUnknown,
          .face_angle_rad = kThreeUnknown,
          .face_slope_rad = kThreeUnknown,
          .length_mm = kThreeUnknown,
          .volume_mm3 = kUnknown};
}

WedgeSigma sigma_from(const JsonNode& node, double mm) {
  WedgeSigma sigma = unknown_sigma();
  sigma.depth_point_mm = mm * node.at("depth_point").number(0);
  sigma.depth_mm = mm * node.at("depth").number(0);
  if (const auto lengths = node.find("edge_lengths")) {
    const std::vector<JsonNode> nodes = three(*lengths);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      sigma.length_mm[k] = nodes[k].is_null() ? kUnknown : mm * nodes[k].number(0);
    }
  }
  const auto read_degrees = [&node](const char* key, Three* angles_rad) {
    if (const auto degrees = node.find(key)) {
      *angles_rad = radians_from(*degrees);
    }
  };
  read_degrees("edges_deg", &sigma.edge_rad);
  read_degrees("edge_slopes_deg", &sigma.edge_slope_rad);
  read_degrees("opening_angles_deg", &sigma.opening_rad);
  read_degrees("face_angles_deg", &sigma.face_angle_rad);
  read_degrees("face_slopes_deg", &sigma.face_slope_rad);
  if (const auto volume = node.find("volume_mm3")) {
    sigma.volume_mm3 = volume->number(0);
  }
  return sigma;
}

OrderedJson place_json(const WedgePlace& place) {
  OrderedJson json;
  json["side"] = to_string(*place.side);
  if (place.line > 0) {
    json["line"] = place.line;
    json["order"] = place.order;
  }
  json["turn_deg"] = deg_from_rad(place.turn_rad);
  if (place.body > 0) {
    json["body"] = place.body;
  }
  return json;
}

WedgePlace place_from(const JsonNode& node) {
  constexpr std::int64_t kMaxInt = std::numeric_limits<int>::max();
  WedgePlace place;
  place.side = static_cast<Face>(node.at("side").one_of(face_names()));
  if (const auto line = node.find("line")) {
    place.line = static_cast<int>(line->integer(1, kMaxInt));
    place.order = static_cast<int>(node.at("order").integer(1, kMaxInt));
  }
  place.turn_rad = rad_from_deg(node.at("turn_deg").number());
  if (const auto body = node.find("body")) {
    place.body = static_cast<int>(body->integer(1, kMaxInt));
  }
  return place;
}

/// What the contract's keys tell of the others; what they do not tell is no number.
void derive_measures(Wedge* wedge) {
  std::array<Eigen::Vector3d, 3> edge;
  for (std::size_t k = 0; k < 3; ++k) {
    edge[k] = wedge->exit_points_mm[k] - wedge->depth_point_mm;
    wedge->edge_lengths_mm[k] = edge[k].norm();
    // Of a surface that is flat above the wedge.
    wedge->edge_slopes_rad[k] = std::asin(std::clamp(wedge->depth_mm / edge[k].norm(), -1.0, 1.0));
  }
  wedge->volume_mm3 = std::abs(edge[0].dot(edge[1].cross(edge[2]))) / 6.0;
  wedge->face_slopes_rad = wedge->edge_bows_mm = kThreeUnknown;
  wedge->roundness = kUnknown;
  wedge->sigma = unknown_sigma();
}

/// What add_measures() writes, as far as it is there.
void measures_from(const JsonNode& node, double mm, Wedge* wedge) {
  derive_measures(wedge);
  if (const auto by = node.find("directional_by")) {
    wedge->directional_by = static_cast<DirectionalBy>(by->one_of(kDirectionalBy));
    wedge->directional_margin = node.at("directional_margin").number();
  }
  if (const auto normal = node.find("surface_normal")) {
    wedge->surface_normal = normal->vector3();
  }
  if (const auto lengths = node.find("edge_lengths")) {
    wedge->edge_lengths_mm = lengths_from(*lengths, mm);
  }
  if (const auto slopes = node.find("edge_slopes_deg")) {
    wedge->edge_slopes_rad = radians_from(*slopes);
  }
  if (const auto slopes = node.find("face_slopes_deg")) {
    wedge->face_slopes_rad = radians_from(*slopes);
  }
  if (const auto bows = node.find("edge_bows")) {
    wedge->edge_bows_mm = lengths_from(*bows, mm);
  }
  if (const auto volume = node.find("volume_mm3")) {
    wedge->volume_mm3 = volume->number(0);
  }
  if (const auto roundness = node.find("roundness")) {
    wedge->roundness = roundness->number();
  }
  if (const auto sigma = node.find("sigma")) {
    wedge->sigma = sigma_from(*sigma, mm);
  }
  if (const auto place = node.find("place")) {
    wedge->place = place_from(*place);
  }
}

}  // namespace

OrderedJson wedge_json(const Wedge& wedge) {
  OrderedJson json;
  json["id"] = wedge.id;
  json["depth_point"] = json_of(wedge.depth_point_mm);
  json["inner_edges"] = OrderedJson::array();
  for (const Eigen::Vector3d& exit : wedge.exit_points_mm) {
    OrderedJson edge;
    edge["exit_point"] = json_of(exit);
    json["inner_edges"].push_back(std::move(edge));
  }
  json["directional_edge"] = wedge.directional_edge;
  json["outer_vertices"] = points_json(wedge.outer_vertices_mm);
  json["face_normals"] = points_json(wedge.face_normals);
  json["depth"] = wedge.depth_mm;
  json["face_angles_deg"] = degrees_json(wedge.face_angles_rad);
  json["opening_angles_deg"] = degrees_json(wedge.opening_angles_rad);
  json["reliability"] = wedge.reliability;
  json["confidence"] = wedge.confidence;
  json["vertex_count"] = wedge.vertex_count;
  json["intact"] = wedge.intact;
  if (wedge.by_hand != ByHand::kNo) {
    json["by_hand"] = kByHandNames[static_cast<std::size_t>(wedge.by_hand)];
  }
  return json;
}

void add_measures(const Wedge& wedge, OrderedJson* json) {
  for (std::size_t k = 0; k < 3; ++k) {
    OrderedJson& edge = (*json)["inner_edges"][k];
    edge["exit_point_surface"] = json_of(wedge.exit_points_surface_mm[k]);
    edge["exit_point_extent"] = json_of(wedge.exit_points_extent_mm[k]);
    if (wedge.beyond_mesh[k]) {
      edge["beyond_mesh"] = true;
    }
  }
  if (are_known(wedge.faces_intact)) {
    (*json)["faces_intact"] = wedge.faces_intact;
  }
  if (is_known(wedge.roundness)) {
    (*json)["roundness"] = wedge.roundness;
  }
  (*json)["directional_by"] = kDirectionalBy[static_cast<std::size_t>(wedge.directional_by)];
  (*json)["directional_margin"] = wedge.directional_margin;
  (*json)["surface_normal"] = json_of(wedge.surface_normal);
  (*json)["edge_lengths"] = wedge.edge_lengths_mm;
  (*json)["volume_mm3"] = wedge.volume_mm3;
  // Of a file with the contract's keys alone some are not known, and JSON has no word for that.
  if (are_known(wedge.edge_slopes_rad)) {
    (*json)["edge_slopes_deg"] = degrees_json(wedge.edge_slopes_rad);
  }
  if (are_known(wedge.face_slopes_rad)) {
    (*json)["face_slopes_deg"] = degrees_json(wedge.face_slopes_rad);
  }
  if (are_known(wedge.edge_bows_mm)) {
    (*json)["edge_bows"] = wedge.edge_bows_mm;
  }
  if (is_known(wedge.sigma.depth_mm)) {
    (*json)["sigma"] = sigma_json(wedge.sigma);
  }
  if (wedge.place.side) {
    (*json)["place"] = place_json(wedge.place);
  }
}

Wedge wedge_from(const JsonNode& node, double mm) {
  constexpr std::int64_t kMaxInt = std::numeric_limits<int>::max();
  Wedge wedge;
  wedge.id = static_cast<int>(node.at("id").integer(0, kMaxInt));
  wedge.depth_point_mm = mm * node.at("depth_point").vector3();
  const std::vector<JsonNode> edges = three(node.at("inner_edges"));
  for (std::size_t k = 0; k < edges.size(); ++k) {
    wedge.exit_points_mm[k] = mm * edges[k].at("exit_point").vector3();
    wedge.exit_points_surface_mm[k] = wedge.exit_points_extent_mm[k] = wedge.exit_points_mm[k];
    if (const auto exit = edges[k].find("exit_point_surface")) {
      wedge.exit_points_surface_mm[k] = mm * exit->vector3();
    }
    if (const auto exit = edges[k].find("exit_point_extent")) {
      wedge.exit_points_extent_mm[k] = mm * exit->vector3();
    }
    if (const auto beyond = edges[k].find("beyond_mesh")) {
      wedge.beyond_mesh[k] = beyond->boolean();
    }
  }
  wedge.directional_edge = static_cast<int>(node.at("directional_edge").integer(0, 2));
  wedge.outer_vertices_mm = points_from(node.at("outer_vertices"), mm);
  wedge.face_normals = points_from(node.at("face_normals"), 1.0);
  wedge.depth_mm = mm * node.at("depth").number();
  wedge.face_angles_rad = radians_from(node.at("face_angles_deg"));
  wedge.opening_angles_rad = radians_from(node.at("opening_angles_deg"));
  wedge.reliability = node.at("reliability").number(0, 1);
  wedge.confidence = node.at("confidence").number(0, 1);
  wedge.vertex_count = static_cast<int>(node.at("vertex_count").integer(0, kMaxInt));
  if (const auto intact = node.find("intact")) {
    wedge.intact = intact->number(0, 1);
  }
  wedge.faces_intact = kThreeUnknown;
  if (const auto faces = node.find("faces_intact")) {
    const std::vector<JsonNode> shares = three(*faces);
    for (std::size_t k = 0; k < shares.size(); ++k) {
      wedge.faces_intact[k] = shares[k].number(0, 1);
    }
  }
  if (const auto by_hand = node.find("by_hand")) {
    static const std::vector<std::string> kNames(kByHandNames.begin(), kByHandNames.end());
    wedge.by_hand = static_cast<ByHand>(by_hand->one_of(kNames));
  }
  measures_from(node, mm, &wedge);
  return wedge;
}

}  // namespace dubsar
