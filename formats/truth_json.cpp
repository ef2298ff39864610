// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/truth_json.h"

#include "core/units.h"
#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "formats/json_text.h"

namespace dubsar {

namespace {

using Three = std::array<double, 3>;

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

std::array<Eigen::Vector3d, 3> points_from(const JsonNode& node, double mm) {
  std::array<Eigen::Vector3d, 3> points{};
  const std::vector<JsonNode> nodes = three(node);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    points[k] = mm * nodes[k].vector3();
  }
  return points;
}

Wedge wedge_from(const JsonNode& node, double mm) {
  constexpr std::int64_t kMaxInt = std::numeric_limits<int>::max();
  Wedge wedge;
  wedge.id = static_cast<int>(node.at("id").integer(0, kMaxInt));
  wedge.depth_point_mm = mm * node.at("depth_point").vector3();
  const std::vector<JsonNode> edges = three(node.at("inner_edges"));
  for (std::size_t k = 0; k < edges.size(); ++k) {
    wedge.exit_points_mm[k] = mm * edges[k].at("exit_point").vector3();
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
  return wedge;
}

}  // namespace

std::string truth_to_json(const TabletTruth& truth) {
  OrderedJson root;
  root["unit"] = "mm";
  root["mesh"] = truth.mesh;
  root["seed"] = truth.seed;
  root["size"] = json_of(truth.size_mm);
  root["spacing_mm"] = truth.spacing_mm;
  root["wedges"] = OrderedJson::array();
  for (const Wedge& wedge : truth.wedges) {
    root["wedges"].push_back(wedge_json(wedge));
  }
  root["rejected"] = OrderedJson::array();
  root["timings_s"] = OrderedJson::object();
  return text_of(root);
}

Status write_truth(const std::filesystem::path& path, const TabletTruth& truth) {
  return write_file_atomically(path, truth_to_json(truth));
}

Result<TabletTruth> parse_truth(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = JsonDocument::parse(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  const double mm = mm_per_unit_of(root);
  TabletTruth truth;
  if (const auto mesh = root.find("mesh")) {
    truth.mesh = mesh->text();
  }
  if (const auto seed = root.find("seed")) {
    truth.seed = seed->unsigned_integer();
  }
  if (const auto size = root.find("size")) {
    truth.size_mm = mm * size->vector3();
  }
  if (const auto spacing = root.find("spacing_mm")) {
    truth.spacing_mm = spacing->number(0);
  }
  for (const JsonNode& node : root.at("wedges").items()) {
    truth.wedges.push_back(wedge_from(node, mm));
  }
  if (Status status = document->status("write the truth again with dubsar simulate tablet"); !status) {
    return std::unexpected(status.error());
  }
  return truth;
}

Result<TabletTruth> read_truth(const std::filesystem::path& path) {
  const Result<std::string> text = read_whole_file(path, kMaxJsonBytes);
  return text ? parse_truth(*text, path.string()) : std::unexpected(text.error());
}

}  // namespace dubsar
