// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "archive/outline.h"
#include "archive/picture_words.h"
#include "core/mesh.h"
#include "core/result.h"
#include "core/rigid_transform.h"
#include "core/wedge.h"

namespace dubsar {

/// The wedges of one side as a drawing to scale: SVG 1.1 in millimetres, seen straight on, up as it is read.
/// One group per wedge with its outer edges, its inner edges, the directional one heavier, and its numbers in
/// a title and as JSON. Wedges of other sides are left out. words: of the tablet; the side's name is added to
/// their title, and all of them stand in the drawing's metadata as RDF. outline: the tablet's rim in the same
/// plane (x the side's right, y its up, mm, text's frame), or none.
[[nodiscard]] std::string wedge_drawing(Face side, const std::vector<Wedge>& wedges,
                                        const RigidTransform& text_from_model, PictureWords words,
                                        const std::vector<OutlineRing>& outline = {});

/// A drawing and the name of its file.
struct WedgeDrawing {
  std::string name;  ///< "obverse.svg"
  std::string svg;
};

/// A drawing of every side that has wedges, or a drawing from before in the folder. mesh: what the wedges are
/// on, for the outline; null leaves it out.
[[nodiscard]] std::vector<WedgeDrawing> wedge_drawings(const std::filesystem::path& folder,
                                                       const std::vector<Wedge>& wedges,
                                                       const RigidTransform& text_from_model,
                                                       const PictureWords& words, const Mesh* mesh = nullptr);

/// Writes those drawings into the folder, which is made; returns the files.
[[nodiscard]] Result<std::vector<std::filesystem::path>> write_wedge_drawings(
    const std::filesystem::path& folder, const std::vector<Wedge>& wedges,
    const RigidTransform& text_from_model, const PictureWords& words, const Mesh* mesh = nullptr);

}  // namespace dubsar
