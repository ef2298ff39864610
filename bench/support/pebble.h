// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/mesh.h"

namespace dubsar::bench {

/// A closed body of a tablet's size (110 × 80 × 30 mm, rounded) with relief all over and about so many
/// million faces, normals with it: what a viewer is timed on where no scan is that large.
[[nodiscard]] Mesh pebble(double million_faces);

}  // namespace dubsar::bench
