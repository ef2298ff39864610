// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/mesh.h"

namespace dubsar {

/// Which way a surface looks as a whole: sums over it by area, about its centre.
struct Facing {
  double area_mm2 = 0;
  Eigen::Vector3d normals_mm2{0, 0, 0};
  double outward_mm3 = 0;  ///< of normal · (p − centre): three times the volume of what is closed
  double spread_mm3 = 0;   ///< of |p − centre|

  /// By the sign of its volume where it is closed, or as good as; where it is open only when it clearly
  /// bulges against its normals, for a bowl that was scanned from above does so a little.
  [[nodiscard]] bool is_inward() const;
};

/// What the faces enclose, mm³, negative where they look inwards; of a mesh that is open, seen from its
/// centre. Broken faces count for nothing.
[[nodiscard]] double signed_volume_mm3(const Mesh& mesh);

/// Whether the faces look into the body that they bulge out of.
[[nodiscard]] bool is_inside_out(const Mesh& mesh);

/// Turns every face over, and the normals, where there are any, with them.
void turn_over(Mesh* mesh);

}  // namespace dubsar
