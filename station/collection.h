// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/result.h"
#include "formats/wedges_json.h"

namespace dubsar {

/// The analysed tablets under a folder.
struct Collection {
  struct Tablet {
    std::string name;  ///< path below the folder
    WedgeFile file;
  };
  std::vector<Tablet> tablets;       ///< in name order
  std::vector<std::string> skipped;  ///< JSON files that are no wedges.json, with the reason
};

/// Reads every .json file at or below the folder, but truth.json. Errors: kBadInput when there is no such
/// folder or nothing analysed in it.
[[nodiscard]] Result<Collection> read_collection(const std::filesystem::path& folder);

struct SimilarWedge {
  std::string tablet;
  int wedge = 0;
  double distance = 0;  ///< in scatters of one hand, over all features
};
struct SimilarTablet {
  std::string tablet;
  int wedges = 0;
  double distance = 0;  ///< mean shift between the feature distributions, in scatters of one hand
};

/// The wedges most like this one; the wedge itself, where it is in the collection, is left out.
[[nodiscard]] std::vector<SimilarWedge> similar_wedges(const Collection& collection, const Wedge& wedge,
                                                       std::size_t count);
/// The tablets whose wedges are distributed most alike; one with just the same wedges is left out, tablets
/// with fewer than five wedges too.
[[nodiscard]] std::vector<SimilarTablet> similar_tablets(const Collection& collection,
                                                         const std::vector<Wedge>& wedges, std::size_t count);

}  // namespace dubsar
