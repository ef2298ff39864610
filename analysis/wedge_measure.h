// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "analysis/evidence.h"
#include "analysis/height_surface.h"
#include "analysis/inner_edges.h"
#include "analysis/wedge_faces.h"
#include "analysis/wedge_patch.h"
#include "core/wedge.h"

namespace dubsar {

/// A wedge before it is judged, with what the judgement needs.
struct WedgeCandidate {
  Wedge wedge;
  std::vector<std::uint32_t> vertices;  ///< of the mesh, that lie on its three faces
  std::vector<std::int8_t> faces;       ///< of each of them, 0 to 2
  EvidenceValues evidence{};            ///< what the judgement rests on
  std::array<double, 3> coverage{};     ///< share of each face that is there, of what the model says
  double explained = 0;                 ///< share of what lies in its outline that lies on its faces
  double rms_mm = 0;                    ///< distance of its vertices from its faces
  double area_mm2 = 0;                  ///< of its outline
  double hollow_mm2 = 0;                ///< of the whole hollow that it was found in
  double level_rim = 0;                 ///< share of that hollow's rim that lies at the free surface
  double floor_mm = 0;                  ///< depth of the lowest clay of that hollow
  double nearest_mm = 0;                ///< of its depth point below the surface of whatever side is nearest
  std::string rejected;                 ///< why it is none; empty while it may be one
};

/// Measures everything that the model of a wedge has. vertex_area_mm2: [V] of the mesh.
[[nodiscard]] WedgeCandidate measure_wedge(const WedgePatch& patch, const WedgeFaces& faces,
                                           const InnerEdges& edges, const HeightSurface& surface,
                                           std::span<const float> vertex_area_mm2, ExitDefinition exits);

}  // namespace dubsar
