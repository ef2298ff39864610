// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/wedges.h"
#include "core/known_wedge.h"
#include "core/wedge.h"

namespace dubsar {

/// The ids that were given so far, with their places: of wedges that there are, and of former ones.
[[nodiscard]] std::vector<KnownWedge> known_wedges(const std::vector<Wedge>& wedges,
                                                   const std::vector<KnownWedge>& former);

/// Those of a wedges.json that is going to be written anew; none where there is no such file, or, with a
/// warning, where it cannot be read.
[[nodiscard]] std::vector<KnownWedge> known_wedges_in(const std::filesystem::path& wedges_json);

/// The same for the wedges of this mesh: a file that names another one may tell of another tablet.
[[nodiscard]] EarlierWedges earlier_wedges(const std::filesystem::path& wedges_json,
                                           const std::filesystem::path& mesh);

/// Adds those of `more` whose ids are not among them.
void add_known(std::vector<KnownWedge> more, std::vector<KnownWedge>* known);

/// What there is to say where most of the earlier wedges are not where they lay.
[[nodiscard]] std::optional<std::string> few_found_again(const EarlierWedges& earlier, const WedgeSet& now);

}  // namespace dubsar
