// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "core/wedge.h"

namespace dubsar {

/// What tells that a file is still the one that was read. The times of change of a status and the numbers of
/// a file cannot be chosen, nor do they survive a copy: an index that came with a copied folder matches
/// nothing in it.
struct FileStamp {
  std::uint64_t size = 0;
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::int64_t modified_ns = 0;
  std::int64_t changed_ns = 0;
  friend bool operator==(const FileStamp&, const FileStamp&) = default;
};

/// One JSON file of a collection, as far as a search needs it.
struct IndexedTablet {
  std::string name;                    ///< path below the folder
  FileStamp stamp;                     ///< all zero: to be read again
  std::string complaint;               ///< why it is no wedges.json; then all below is empty
  std::int32_t method = 0;             ///< WedgeFile::method; 0: it says none
  std::vector<int> ids;                ///< [W] of its wedges
  std::vector<std::uint64_t> digests;  ///< [W] wedge_digest()
  std::vector<float> features;         ///< [W × columns], comparable
  std::vector<float> profile;          ///< [profile columns], comparable; empty with too few wedges
};

/// What `dubsar search` keeps beside the analysed tablets of a folder (docs/formats/search_index.md).
struct SearchIndex {
  std::uint32_t columns = 0;          ///< features of a wedge
  std::uint32_t profile_columns = 0;  ///< of a tablet's profile
  std::vector<IndexedTablet> tablets;
  std::string wedge_tree;   ///< FeatureSearch::tree() over all features, in the order of the tablets
  std::string tablet_tree;  ///< the same over all profiles
};

inline constexpr std::string_view kSearchIndexName = ".dubsar-search";

/// Of its depth point and exit points: equal where they are.
[[nodiscard]] std::uint64_t wedge_digest(const Wedge& wedge);

[[nodiscard]] std::string search_index_to_bytes(const SearchIndex& index);
/// Errors: kBadInput when the bytes are damaged or of another version.
[[nodiscard]] Result<SearchIndex> parse_search_index(std::string_view bytes, const std::string& where);

}  // namespace dubsar
