// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "archive/image.h"

namespace dubsar::ui {

/// A ball of clay under a soft light from the upper left, seen along z: the picture that lit-sphere shading
/// looks its colours up in (Sloan et al. 2001). Grey: the surface brings its own colour.
[[nodiscard]] Image clay_sphere();

}  // namespace dubsar::ui
