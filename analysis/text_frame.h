// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "core/mesh.h"
#include "core/rigid_transform.h"
#include "core/wedge.h"

namespace dubsar {

/// Text that decides how a tablet lies has to lead the next best reading by this (TextFrame::certainty).
inline constexpr double kCertainText = 0.1;

/// How the text lies: z out of the obverse, x to the reader's right, y up the obverse. A tablet is turned
/// over its lower edge, so that x is the reader's right on the reverse too, and the reverse's up is -y.
struct TextFrame {
  RigidTransform text_from_model;
  /// By how much this reading of right and up leads the next best, 0 to 1; 0 where hardly a wedge says it.
  double certainty = 0;
};

/// From the tablet's shape (core/tablet_frame.h) and its wedges: their tails run to the right, down and to
/// the lower right, never up or to the left but for the odd Winkelhaken; the side with clearly more text is
/// the obverse, else the one along the tablet frame's z. A reading that hardly leads leaves that frame as it
/// is.
[[nodiscard]] TextFrame find_text_frame(const Mesh& mesh, const std::vector<Wedge>& wedges);

/// Gives each wedge its side, its line on that side, its order in the line and its turn. Lines are found
/// where fewest wedges are cut by the gap between them; a lone line is line 1. No line runs over two bodies
/// (place.body): a side's lines are counted on from one body to the next.
void place_wedges(const TextFrame& frame, std::vector<Wedge>* wedges);

}  // namespace dubsar
