// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "triangulation/half_edges.h"

namespace dubsar {

/// Numbers the fans of faces around a vertex, joined across the edges that faces share in opposite
/// directions, in the order of the half-edges that leave it: fan[i] is that of the i-th. Returns how many
/// there are. Where more faces than two meet at an edge each goes on into one other at the most.
std::uint32_t number_fans(std::span<const Triangle> faces, const HalfEdges& edges, std::uint32_t v,
                          std::vector<std::uint32_t>& fan);

/// Whether the faces around a vertex hang together across the edges at it, whichever way faces run along them
/// and however many meet there.
bool is_one_fan(std::span<const Triangle> faces, const HalfEdges& edges, std::uint32_t v);

}  // namespace dubsar
