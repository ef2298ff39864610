// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh.h"
#include "core/result.h"

namespace dubsar {

// A primitive as KHR_draco_mesh_compression keeps it: triangles and their vertices in Draco's bitstream 2.2.

/// Positions come back as whole multiples of this, each less than one from where it was on every axis. A
/// power of two, so that each multiple is a float and the same mesh again stays as it is: 2^-16 mm (0.0153
/// µm) for what reaches no farther than 128 mm from the origin and from end to end, twice that to 256 mm and
/// so on, which is what a float keeps there.
[[nodiscard]] double draco_step_mm(const Mesh& mesh);

/// Unit normals come back to within this.
inline constexpr double kDracoNormalError_deg = 0.25;

/// What there is to compress beside positions and faces; empty where there is nothing of the kind.
struct DracoAttributes {
  std::span<const Eigen::Vector3f> normals;               ///< unit
  std::span<const std::array<std::uint16_t, 4>> colours;  ///< kept to the bit
};

/// By which the bitstream knows the positions; the others follow.
inline constexpr int kDracoPosition = 0;

struct DracoStream {
  std::string bytes;
  std::optional<int> normal, colour;  ///< by which the bitstream knows them; nothing where there are none
  std::uint64_t vertices = 0;         ///< as they come out: none that no face has
  std::uint64_t faces = 0;            ///< those with three different corners
  Eigen::Vector3f low, high;          ///< of the positions as they come out
};

/// Compresses; the order of vertices and faces is not kept. Takes about 100 bytes of memory a face, and once
/// begun it cannot be stopped (half a second a million faces). Errors: kUsage for more faces than Draco
/// counts, no proper face, positions that are not finite, and what decode_draco() would not believe (see
/// max_packed_items).
[[nodiscard]] Result<DracoStream> encode_draco(const Mesh& mesh, const DracoAttributes& attributes,
                                               const std::string& where);

/// Numbers of the vertices, one after the other as a buffer view of glTF has them.
struct DracoNumbers {
  std::string bytes;
  int component_type = 0;  ///< of glTF
  std::size_t components = 0;
};

struct DracoMesh {
  std::vector<std::uint32_t> corners;  ///< three a face; any numbers where the bytes are damaged
  std::vector<DracoNumbers> numbers;   ///< of the attributes that were asked for, in that order
};

/// What the file says of a bitstream; where it holds anything else it is refused.
struct DracoClaim {
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
  std::vector<std::uint32_t> attributes;  ///< their numbers in the bitstream
};

/// Decompresses. The claim is held against the length of the bytes (max_packed_items), and what the bytes
/// say against the claim, before memory is taken for it. What Draco believes of damaged bytes all the same is
/// bounded, too: tables of 768 bytes a byte, and 256 MiB for an attribute that it predicts as places in a
/// texture (its release 1.5.5). The error goes on where the name of the primitive ends: "holds damaged Draco
/// data".
[[nodiscard]] std::expected<DracoMesh, std::string> decode_draco(std::string_view bytes,
                                                                 const DracoClaim& claim);

/// The most faces, and the most vertices, that are believed of so many bytes. A scan takes three bytes for a
/// face, an even plane of a million and more one for five, and strips of it even less: they are not written.
[[nodiscard]] constexpr std::uint64_t max_packed_items(std::uint64_t bytes) {
  constexpr std::uint64_t kAlways = 65536;
  constexpr std::uint64_t kItemsPerByte = 8;
  return kAlways + kItemsPerByte * bytes;
}

}  // namespace dubsar
