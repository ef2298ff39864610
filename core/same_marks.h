// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>

#include "core/rigid_transform.h"
#include "core/scan_marks.h"

namespace dubsar {

/// The motion that lays the samples of `part` on those of `whole`, where the marks of nearly all of `part`
/// are there within rounding: both are one measurement. `part` is the one with fewer samples. Two scans from
/// one place have other noise, and those of a noise-free simulation from two places have samples elsewhere.
[[nodiscard]] std::optional<RigidTransform> whole_from_part(const ScanMarks& whole, const ScanMarks& part);

}  // namespace dubsar
