// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "archive/wedge_annotations.h"
#include "archive/wedges_in_view.h"

namespace dubsar {

/// A canvas of a manifest, as large as its picture.
struct AnnotatedCanvas {
  std::string id;
  int width = 0;
  int height = 0;
};

/// The wedges that a canvas shows as a page of IIIF Presentation 3.0: the target of each is a part of the
/// canvas, told both as the rectangle round it (media fragment xywh) and as its triangle (SVG), for viewers
/// know one or the other. Its id ends in the wedge's number, on a canvas of several views in the side too.
/// `source.model` is not looked at.
[[nodiscard]] std::string canvas_annotations(const std::vector<Wedge>& wedges,
                                             const std::vector<WedgeOnPicture>& shown,
                                             const AnnotatedCanvas& canvas, const AnnotationSource& source);

}  // namespace dubsar
