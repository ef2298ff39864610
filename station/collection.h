// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/feature_search.h"
#include "core/result.h"
#include "core/wedge.h"
#include "formats/search_index.h"
#include "formats/wedges_json.h"
#include "station/analysed_files.h"

namespace dubsar {

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

/// Of the tablets that are searched, those whose wedges were measured in another way (WedgeFile::method).
struct OtherMethods {
  std::size_t searched = 0;              ///< tablets with wedges
  std::size_t others = 0;                ///< of these
  const IndexedTablet* first = nullptr;  ///< in name order; null: there is none
};

/// What IndexedTablet::complaint says of a .json that never was a wedges.json: no more than that.
inline constexpr std::string_view kNoWedgesJson = "no wedges.json";

/// Tablets with fewer are not compared: their deciles are those of a few impressions.
inline constexpr std::size_t kFewestWedges = 5;

/// A wedges.json as it is compared: lengths to where the edges meet the surface, whichever definition was
/// chosen for it. Else the choice would tell two hands apart. kBadInput also where its measures are such that
/// nothing can be compared with them.
[[nodiscard]] Result<WedgeFile> read_compared_wedges(const std::filesystem::path& path);

/// The analysed tablets under a folder, ready to be searched. What is known of them is kept in the folder
/// (formats/search_index.h): only what has changed since is read again.
class Collection {
 public:
  /// Takes in one file for each tablet (analysed_files.h) and keeps the index; an index that is
  /// damaged, foreign or cannot be written costs time alone and is told in `remark`; in a session or package
  /// none is kept. Errors: kBadInput when
  /// there is no such folder or nothing analysed in it.
  /// A file that changed less than `settled` before it is read may change once more without its times
  /// telling, for some file systems count whole seconds: it is read again next time.
  [[nodiscard]] static Result<Collection> open(const std::filesystem::path& folder,
                                               std::chrono::milliseconds settled = std::chrono::seconds(2));

  [[nodiscard]] const std::vector<IndexedTablet>& files() const { return index_.tablets; }
  [[nodiscard]] std::size_t read_anew() const { return read_anew_; }
  [[nodiscard]] const std::string& remark() const { return remark_; }  ///< empty when there is none
  /// What was left out because it cannot be read.
  [[nodiscard]] const std::vector<UnreadPlace>& unread() const { return unread_; }
  /// As AnalysedFiles has them.
  [[nodiscard]] const std::vector<std::string>& lost_sessions() const { return lost_sessions_; }

  /// What is not to be compared with wedges of this method.
  [[nodiscard]] OtherMethods measured_otherwise(int method) const;

  /// The wedges most like this one; the wedge itself, where it is in the collection, is left out.
  [[nodiscard]] std::vector<SimilarWedge> similar_wedges(const Wedge& wedge, std::size_t count) const;
  /// The tablets whose wedges are distributed most alike; one with just the same wedges is left out, tablets
  /// with fewer than kFewestWedges too. None for a tablet without wedges.
  [[nodiscard]] std::vector<SimilarTablet> similar_tablets(const WedgeFile& tablet, std::size_t count) const;

 private:
  struct Row {
    std::size_t tablet, wedge;
  };
  Collection() = default;
  /// Rows and trees, the kept ones where that will do; whether any was made.
  bool plant(bool anew);

  SearchIndex index_;
  std::vector<Row> wedge_rows_;
  std::vector<std::size_t> tablet_rows_;
  std::optional<FeatureSearch> wedges_, tablets_;
  std::size_t read_anew_ = 0;
  std::string remark_;
  std::vector<UnreadPlace> unread_;
  std::vector<std::string> lost_sessions_;
};

}  // namespace dubsar
