// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Rossignac, Edgebreaker: Connectivity Compression for Triangle Meshes (1999), as Google's Draco has it.
#include <draco/compression/expert_encode.h>
#include <draco/core/encoder_buffer.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/draco_mesh.h"

namespace dubsar {

namespace {

/// Of an octahedron's unfolded sides; measured over the sphere, 10 bits are within kDracoNormalError_deg.
constexpr int kNormalBits = 10;
/// 0 to 10. On 13.8 million faces with noise of 5 µm: 4 took 6.9 s for 40.6 MB, 5 took 5.9 s for 44.1 MB, 3
/// was slower and larger than 4.
constexpr int kSpeed = 4;
constexpr double kFinestStep_mm = 0x1p-16;
constexpr double kMostSteps = 0x1p23;  ///< Draco rounds by adding 0.5 to a float

struct Reach {
  Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::max());
  Eigen::Vector3f high = -low;
  std::uint64_t faces = 0;
  bool finite = true;
};

bool is_proper(const std::array<std::uint32_t, 3>& f) {
  return f[0] != f[1] && f[1] != f[2] && f[2] != f[0];
}

/// Of what is compressed: vertices of proper faces.
Reach reach_of(const Mesh& mesh) {
  Reach reach;
  for (const auto& face : mesh.faces) {
    if (!is_proper(face)) {
      continue;
    }
    ++reach.faces;
    for (const std::uint32_t v : face) {
      reach.finite = reach.finite && mesh.positions[v].allFinite();
      reach.low = reach.low.cwiseMin(mesh.positions[v]);
      reach.high = reach.high.cwiseMax(mesh.positions[v]);
    }
  }
  return reach;
}

double step_of(const Reach& reach) {
  if (reach.faces == 0 || !reach.finite) {
    return kFinestStep_mm;
  }
  const Eigen::Vector3d low = reach.low.cast<double>();
  const Eigen::Vector3d high = reach.high.cast<double>();
  const double farthest =
      std::max({low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff(), (high - low).maxCoeff()});
  double step = kFinestStep_mm;
  while (farthest > step * kMostSteps) {
    step *= 2;
  }
  return step;
}

/// An attribute of the mesh with these values, one a vertex.
template <class Value>
void add(draco::Mesh& to, draco::GeometryAttribute::Type type, draco::DataType number, int components,
         bool normalized, std::span<const Value> values) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, static_cast<std::uint8_t>(components), number, normalized, sizeof(Value), 0);
  const int id =
      to.AddAttribute(attribute, true, static_cast<draco::AttributeValueIndex::ValueType>(values.size()));
  to.attribute(id)->buffer()->Write(0, values.data(), values.size_bytes());
}

}  // namespace

double draco_step_mm(const Mesh& mesh) {
  return step_of(reach_of(mesh));
}

Result<DracoStream> encode_draco(const Mesh& mesh, const DracoAttributes& attributes,
                                 const std::string& where) {
  constexpr std::uint64_t kMostCorners = std::numeric_limits<std::int32_t>::max();
  if (3 * mesh.faces.size() > kMostCorners || mesh.positions.size() > kMostCorners) {
    return fail(ErrorKind::kUsage, "the mesh has more faces than Draco counts (715827882)", where,
                "write .ply instead");
  }
  const Reach reach = reach_of(mesh);
  if (reach.faces == 0 || !reach.finite) {
    return fail(ErrorKind::kUsage,
                reach.finite ? "the mesh has no face that Draco compresses" : "a position is not finite",
                where, "write .ply instead");
  }
  draco::Mesh packed;
  packed.set_num_points(static_cast<draco::PointIndex::ValueType>(mesh.positions.size()));
  packed.SetNumFaces(mesh.faces.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& [a, b, c] = mesh.faces[f];
    packed.SetFace(draco::FaceIndex(static_cast<std::uint32_t>(f)),
                   {draco::PointIndex(a), draco::PointIndex(b), draco::PointIndex(c)});
  }
  using Attribute = draco::GeometryAttribute;
  add(packed, Attribute::POSITION, draco::DT_FLOAT32, 3, false, std::span(mesh.positions));
  int next = kDracoPosition;
  DracoStream out;
  if (!attributes.normals.empty()) {
    add(packed, Attribute::NORMAL, draco::DT_FLOAT32, 3, false, attributes.normals);
    out.normal = ++next;
  }
  if (!attributes.colours.empty()) {
    add(packed, Attribute::COLOR, draco::DT_UINT16, 4, true, attributes.colours);
    out.colour = ++next;
  }

  const double step = step_of(reach);
  const auto on_grid = [&](float value) { return std::floor(static_cast<double>(value) / step) * step; };
  const Eigen::Vector3f origin = reach.low.unaryExpr([&](float v) { return static_cast<float>(on_grid(v)); });
  const double extent = (reach.high.cast<double>() - origin.cast<double>()).maxCoeff();
  int bits = 1;
  while (std::ldexp(1.0, bits) - 1 < extent / step) {
    ++bits;
  }
  draco::ExpertEncoder encoder(packed);
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetSpeedOptions(kSpeed, kSpeed);
  // No attribute has seams: one connectivity serves all.
  encoder.options().SetGlobalBool("split_mesh_on_seams", true);
  encoder.SetTrackEncodedProperties(true);
  encoder.SetAttributeExplicitQuantization(kDracoPosition, bits, 3, origin.data(),
                                           static_cast<float>((std::ldexp(1.0, bits) - 1) * step));
  if (out.normal) {
    encoder.SetAttributeQuantization(*out.normal, kNormalBits);
  }
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeToBuffer(&buffer).ok()) {
    return fail(ErrorKind::kUsage, "Draco cannot compress the mesh", where, "write .ply instead");
  }
  out.bytes.assign(buffer.data(), buffer.size());
  out.vertices = encoder.num_encoded_points();
  out.faces = encoder.num_encoded_faces();
  if (std::max(out.vertices, out.faces) > max_packed_items(out.bytes.size())) {
    return fail(ErrorKind::kUsage, "the mesh is so even that its compressed form would not be believed",
                where, "write .glb or .ply instead");
  }
  // As Draco rounds, and as its decoder has them: whole steps from the origin, each of them a float.
  const auto rounded = [&](const Eigen::Vector3f& p) -> Eigen::Vector3f {
    const Eigen::Array3f steps = (p - origin).array() * static_cast<float>(1 / step) + 0.5F;
    return origin.array() + steps.floor() * static_cast<float>(step);
  };
  out.low = rounded(reach.low);
  out.high = rounded(reach.high);
  return out;
}

}  // namespace dubsar
