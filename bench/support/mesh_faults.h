// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>

#include "core/mesh.h"

namespace dubsar::bench {

/// Spoils a mesh as poor merging does: one face in a hundred deleted, one duplicated or flipped, and loose
/// scraps of a few faces strewn about and inside it, as many as one in a thousand faces.
void add_faults(std::uint64_t seed, Mesh* mesh);

}  // namespace dubsar::bench
