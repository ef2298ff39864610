// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/wedge.h"
#include "formats/wedges_json.h"

namespace dubsar {

/// All that there is to doubt in these wedges, for whoever shows them or hands them on: that the mesh holds
/// several bodies, that no text runs through them, that the mesh is too coarse, that most of them are worn.
/// `where`: the mesh or the file, or nothing; `bodies`: of the mesh, 0 where nobody counted them: then the
/// wedges' places tell.
[[nodiscard]] std::vector<Error> doubts_of(const WedgeFile& file, const std::string& where,
                                           std::size_t bodies = 0);

/// What there is to say where the mesh is too coarse for wedges of the usual size, and those that were found,
/// if any, are not larger ones. Nothing where the file does not say its spacing.
[[nodiscard]] std::optional<Error> too_coarse(const WedgeFile& file, const std::string& where);

/// What there is to say where more than half of the wedges are rounder than kMostRoundness.
[[nodiscard]] std::optional<Error> worn(const std::vector<Wedge>& wedges, const std::string& where);

}  // namespace dubsar
