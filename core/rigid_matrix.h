// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <span>

#include "core/rigid_transform.h"

namespace dubsar {

/// How 16 numbers hold a transform: for messages about those that do not.
inline constexpr const char* kRigidMatrixLayout =
    "4 x 4, row by row: a right-handed turn without scale, the translation in millimetres in the last "
    "column, "
    "last row 0 0 0 1";

/// The transform of 16 numbers that come from outside, or nothing where they are none (kRigidMatrixLayout):
/// where the turn is none (RigidTransform::is_rigid()), a number is not finite, or the last row is not 0 0 0
/// 1 to 1e-9, as in a matrix that was written column by column. The turn is taken as it is: see
/// RigidTransform::orthonormalised().
[[nodiscard]] std::optional<RigidTransform> rigid_from_row_major(std::span<const double, 16> numbers);

}  // namespace dubsar
