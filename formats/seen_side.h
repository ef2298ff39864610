// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "core/range_grid.h"
#include "core/result.h"

namespace dubsar {

/// Which side a grid was seen from, where its file does not say. Two witnesses: the outline, where an object
/// curves away from whoever looks at it, and the turn from columns to rows, which scanners set anticlockwise
/// as they see it (but a profile that is read backwards reverses it, so that alone it proves nothing).

/// Of a grid that is read as seen along view.direction for want of a better word: turns the direction where
/// both witnesses say so, and takes the axis that its rows and columns show where its frame is plainly not
/// the scanner's. Answers with what the operator should know, then or where it is doubtful; else empty.
[[nodiscard]] std::string settle_direction(RangeGrid& grid);

/// Whether a grid's outline falls away from the scanner that view.direction says: 1; towards it, so that it
/// was seen from the other side: -1; 0 where it does not tell.
[[nodiscard]] int outline_side(const RangeGrid& grid);

/// Turns the direction to the axis that rows and columns show, where that lies so far from it that the frame
/// is plainly not the scanner's; true then. Its side is that of the outline, else of the turn.
[[nodiscard]] bool take_shown_axis(RangeGrid& grid);

/// Of a grid of which not even the axis is known: the direction from its facets and its outline. kBadInput
/// when they leave it open.
[[nodiscard]] Status find_direction(RangeGrid& grid, const std::string& name);

}  // namespace dubsar
