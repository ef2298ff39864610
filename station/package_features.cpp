// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/package_features.h"

#include "analysis/body_fields.h"
#include "analysis/mesh_bodies.h"
#include "analysis/outlook.h"
#include "analysis/vertex_geometry.h"
#include "analysis/vertex_graph.h"
#include "formats/feature_mat.h"
#include "station/package_content.h"

namespace dubsar {

namespace {

constexpr double kRadiusMm = 1.0;

}  // namespace

Result<PackageFields> package_fields(const Mesh& mesh, const JobContext& job) {
  PackageFields fields;
  double mean_edge_mm = 0;
  std::vector<std::uint8_t> body_of;
  {
    const VertexGraph graph = make_vertex_graph(mesh);
    const VertexGeometry geometry = make_vertex_geometry(mesh, graph);
    mean_edge_mm = geometry.mean_edge_mm;
    body_of = find_bodies(mesh, geometry).of;
    fields.openness = openness_of_bodies(mesh, geometry, {}, job);
  }
  if (!job.cancelled()) {
    const std::vector<Eigen::Vector3f> outlook =
        of_each_body(mesh, body_of, [](const Mesh& body) { return mean_outlook(body, kRadiusMm); });
    fields.invariants = strongest_response(
        invariants_of_bodies(mesh, body_of, outlook, mean_edge_mm, {.radius_mm = kRadiusMm}, job));
  }
  if (job.cancelled()) {
    return fail(ErrorKind::kCancelled, "stopped");
  }
  return fields;
}

Status add_features(PackageContent& content) {
  const Mesh& mesh = content.mesh();
  if (mesh.faces.empty()) {
    return {};
  }
  if (const Status had = content.need_fields(); !had) {
    return had;
  }
  struct Feature {
    const char* name;
    const std::vector<float>& value;
    const char* comment;
    const char* what;
  };
  const Feature kFeatures[] = {
      {"reliability", mesh.reliability, "reliability of the vertex, 0 to 1",
       "how far each vertex is to be trusted"},
      {"openness", content.fields->openness, "ambient occlusion: 1 open, 0 buried",
       "how much of the sky each vertex sees"},
      {"msii", content.fields->invariants,
       "multi-scale integral invariants within 1 mm, f = 2 V_below / V_sphere - 1: the one of largest "
       "magnitude over the radii that the mesh resolves; above 0 in a valley",
       "how hollow the clay is about each vertex"}};
  const auto made = content.place("features/x");
  if (!made) {
    return std::unexpected(made.error());
  }
  for (const Feature& feature : kFeatures) {
    if (feature.value.size() != mesh.positions.size()) {
      continue;  // a mesh of an earlier version has no reliability
    }
    const std::string path = std::string("features/") + feature.name + ".mat";
    if (content.job.cancelled()) {
      return fail(ErrorKind::kCancelled, "stopped");
    }
    std::string comment = feature.comment;
    comment.append("\n").append(label_lines(content.label, ""));
    if (const Status written = write_feature_mat(content.root / path, feature.value, 1, comment); !written) {
      return written;
    }
    content.list(path,
                 std::string(feature.what) +
                     ": vertex of the model (PLY), value; text as GigaMesh has it: formats/feature_mat.txt");
  }
  return {};
}

}  // namespace dubsar
