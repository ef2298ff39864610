// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Draco's decoders with a look at what the bitstream claims before they take memory for it.
#include <draco/compression/config/decoder_options.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/decoder_buffer.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>

#include "formats/draco_mesh.h"
#include "formats/glb_container.h"

namespace dubsar {

namespace {

constexpr const char* kDamaged = "holds damaged Draco data";
/// What glTF names: positions, normals, tangents, colours, places in two textures, joints, weights.
constexpr int kMostAttributes = 8;
constexpr int kMostComponents = 32;

/// The number at the front; Draco's own way to write it.
std::optional<std::uint32_t> next_number(draco::DecoderBuffer& buffer) {
  std::uint32_t number = 0;
  return draco::DecodeVarint(&number, &buffer) ? std::optional(number) : std::nullopt;
}

/// `Decoder` that goes on only where what it is about to make is what the file's accessors say.
template <class Decoder>
class Bounded : public Decoder {
 public:
  explicit Bounded(const DracoClaim& claim) : claim_(claim) {}
  /// Why it stopped; empty where Draco itself did.
  [[nodiscard]] const std::string& complaint() const { return complaint_; }

 protected:
  bool DecodeConnectivity() override;

  /// All vertices are known by now, and the attributes by name.
  bool DecodeAllAttributes() override {
    const draco::PointCloud& cloud = *this->point_cloud();
    int components = 0;
    for (int a = 0; a < cloud.num_attributes(); ++a) {
      components += cloud.attribute(a)->num_components();
    }
    if (cloud.num_attributes() > kMostAttributes || components > kMostComponents) {
      return refuse("holds more attributes than are read");
    }
    return check_counts(this->mesh()->num_faces(), cloud.num_points()) && Decoder::DecodeAllAttributes();
  }

 private:
  bool refuse(const char* complaint) {
    complaint_ = complaint;
    return false;
  }
  bool check_counts(std::uint64_t faces, std::uint64_t vertices) {
    return (faces == claim_.faces && vertices == claim_.vertices) ||
           refuse("holds other numbers of faces or vertices than its accessors say");
  }

  const DracoClaim& claim_;
  std::string complaint_;
};

/// Faces and vertices stand in front.
template <>
bool Bounded<draco::MeshSequentialDecoder>::DecodeConnectivity() {
  draco::DecoderBuffer ahead = *buffer();
  const auto faces = next_number(ahead);
  const auto vertices = next_number(ahead);
  return faces && vertices && check_counts(*faces, *vertices) && MeshSequentialDecoder::DecodeConnectivity();
}

/// Vertices and faces stand in front. A vertex on a seam becomes several, so of these there may be fewer.
template <>
bool Bounded<draco::MeshEdgebreakerDecoder>::DecodeConnectivity() {
  draco::DecoderBuffer ahead = *buffer();
  const auto vertices = next_number(ahead);
  const auto faces = next_number(ahead);
  std::uint8_t seams = 0;
  if (!vertices || !faces || !ahead.Decode(&seams)) {
    return false;
  }
  if (seams > kMostAttributes) {
    return refuse("holds more attributes than are read");
  }
  return check_counts(*faces, std::max<std::uint64_t>(*vertices, claim_.vertices)) &&
         MeshEdgebreakerDecoder::DecodeConnectivity();
}

/// Why the bytes were not decoded; empty where they were.
template <class Decoder>
std::optional<std::string> decode_with(draco::DecoderBuffer& buffer, const DracoClaim& claim,
                                       draco::Mesh& mesh) {
  Bounded<Decoder> decoder(claim);
  if (decoder.Decode(draco::DecoderOptions(), &buffer, &mesh).ok()) {
    return std::nullopt;
  }
  return decoder.complaint().empty() ? kDamaged : decoder.complaint();
}

/// 0 where glTF has no such numbers.
int component_type_of(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return kGltfByte;
    case draco::DT_UINT8:
      return kGltfUnsignedByte;
    case draco::DT_INT16:
      return kGltfShort;
    case draco::DT_UINT16:
      return kGltfUnsignedShort;
    case draco::DT_UINT32:
      return kGltfUnsignedInt;
    case draco::DT_FLOAT32:
      return kGltfFloat;
    default:
      return 0;
  }
}

std::expected<DracoNumbers, std::string> numbers_of(const draco::Mesh& mesh, std::uint32_t number) {
  const int id = mesh.GetAttributeIdByUniqueId(number);
  if (id < 0) {
    return std::unexpected("lacks in its Draco data attribute " + std::to_string(number));
  }
  const draco::PointAttribute& attribute = *mesh.attribute(id);
  DracoNumbers out;
  out.component_type = component_type_of(attribute.data_type());
  out.components = attribute.num_components();
  if (out.component_type == 0) {
    return std::unexpected("holds Draco data with numbers that glTF has not");
  }
  const auto bytes = static_cast<std::size_t>(attribute.byte_stride());
  out.bytes.reserve(bytes * mesh.num_points());
  for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
    const draco::AttributeValueIndex value = attribute.mapped_index(point);
    if (value.value() >= attribute.size()) {
      return std::unexpected(kDamaged);
    }
    out.bytes.append(reinterpret_cast<const char*>(attribute.GetAddress(value)), bytes);
  }
  return out;
}

}  // namespace

std::expected<DracoMesh, std::string> decode_draco(std::string_view bytes, const DracoClaim& claim) {
  if (std::max(claim.faces, claim.vertices) > max_packed_items(bytes.size())) {
    return std::unexpected("claims more faces or vertices than its " + std::to_string(bytes.size()) +
                           " bytes of Draco data can hold");
  }
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::DecoderBuffer ahead = buffer;
  draco::DracoHeader header;
  if (!draco::PointCloudDecoder::DecodeHeader(&ahead, &header).ok() ||
      header.encoder_type != draco::TRIANGULAR_MESH) {
    return std::unexpected(kDamaged);
  }
  // Those before it are read by other code, with fewer checks; glTF never had them.
  if (header.version_major != 2 || header.version_minor != 2) {
    return std::unexpected("holds Draco data of version " + std::to_string(header.version_major) + "." +
                           std::to_string(header.version_minor) + ", and only 2.2 is read");
  }
  if ((header.flags & METADATA_FLAG_MASK) != 0) {
    return std::unexpected("holds Draco data with metadata, which are not read");
  }
  draco::Mesh mesh;
  const auto complaint = header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING
                             ? decode_with<draco::MeshEdgebreakerDecoder>(buffer, claim, mesh)
                             : decode_with<draco::MeshSequentialDecoder>(buffer, claim, mesh);
  if (complaint) {
    return std::unexpected(*complaint);
  }
  DracoMesh out;
  out.corners.reserve(3 * std::size_t{mesh.num_faces()});
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
    for (const draco::PointIndex& corner : mesh.face(f)) {
      out.corners.push_back(corner.value());
    }
  }
  for (const std::uint32_t number : claim.attributes) {
    auto numbers = numbers_of(mesh, number);
    if (!numbers) {
      return std::unexpected(numbers.error());
    }
    out.numbers.push_back(std::move(*numbers));
  }
  return out;
}

}  // namespace dubsar
