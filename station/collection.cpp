// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/collection.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <system_error>

#include "analysis/wedge_features.h"
#include "core/parallel.h"
#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "station/place_outside.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// The wedge that is searched by may be in the collection more than once, and so may the tablet.
constexpr std::size_t kCopies = 16;

std::int64_t nanoseconds(const timespec& t) {
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

/// All zero for one that is gone or may still be changing.
FileStamp stamp_of(const fs::path& path, std::chrono::milliseconds settled) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    return {};
  }
  const std::int64_t changed = nanoseconds(status.st_ctim);
  const auto latest = std::chrono::system_clock::now() - settled;
  if (changed > std::chrono::duration_cast<std::chrono::nanoseconds>(latest.time_since_epoch()).count()) {
    return {};
  }
  return {static_cast<std::uint64_t>(status.st_size), status.st_dev, status.st_ino,
          nanoseconds(status.st_mtim), changed};
}

/// Sessions and packages hold many a .json that has no list of wedges. Text that is no JSON at all is not
/// meant: it may have been one.
bool is_of_another_kind(const fs::path& path) {
  const Result<std::string> text = read_whole_file(path, kMaxJsonBytes);
  if (!text) {
    return false;
  }
  const Result<JsonDocument> document = JsonDocument::parse(*text, path.string());
  if (!document) {
    const nlohmann::json other = nlohmann::json::parse(*text, nullptr, false);
    return !other.is_discarded() && !other.is_object();
  }
  const JsonNode root = document->root();
  const std::optional<JsonNode> wedges = root.find("wedges");
  return !wedges || (wedges->items().empty() && root.failed());
}

/// `name`: of the file below the folder.
IndexedTablet read_tablet(const fs::path& path, const std::string& name, std::chrono::milliseconds settled) {
  IndexedTablet tablet;
  tablet.name = name;
  tablet.stamp =
      stamp_of(path, settled);  // before it is read: what changes meanwhile is read again next time
  const Result<WedgeFile> file = read_compared_wedges(path);
  if (!file) {
    Error error = file.error();
    error.where = name;
    tablet.complaint = is_of_another_kind(path) ? std::string(kNoWedgesJson) : error.line();
    return tablet;
  }
  tablet.method = file->method;
  for (const Wedge& wedge : file->wedges) {
    tablet.ids.push_back(wedge.id);
    tablet.digests.push_back(wedge_digest(wedge));
    const std::vector<float> row = comparable(wedge);
    tablet.features.insert(tablet.features.end(), row.begin(), row.end());
  }
  if (file->wedges.size() >= kFewestWedges) {
    tablet.profile = comparable(file->wedges);
  }
  return tablet;
}

/// As it was kept, or empty; `remark` when it was there and of no use.
SearchIndex read_index(const fs::path& path, std::string* remark) {
  SearchIndex fresh;
  fresh.columns = static_cast<std::uint32_t>(kWedgeFeatures.size());
  fresh.profile_columns = static_cast<std::uint32_t>(kWedgeFeatures.size() * kProfileQuantiles);
  std::error_code error;
  if (!fs::exists(path, error)) {
    return fresh;
  }
  const Result<std::string> bytes = read_whole_file(path);
  Result<SearchIndex> kept =
      bytes ? parse_search_index(*bytes, path.string()) : Result<SearchIndex>(std::unexpected(bytes.error()));
  if (!kept || kept->columns != fresh.columns || kept->profile_columns != fresh.profile_columns) {
    *remark = fmt::format("{}: {}; it is made again", path.string(),
                          kept ? "the search index of another version" : kept.error().what);
    return fresh;
  }
  return *std::move(kept);
}

}  // namespace

Result<WedgeFile> read_compared_wedges(const fs::path& path) {
  Result<WedgeFile> file = read_wedges(path);
  if (file && file->exits != ExitDefinition::kSurface) {
    for (Wedge& wedge : file->wedges) {
      wedge.exit_points_mm = wedge.exit_points_surface_mm;
    }
    file->profiles.clear();  // of the other lengths
  }
  const auto is_finite = [](float value) { return std::isfinite(value); };
  if (file && !std::ranges::all_of(file->wedges, [&](const Wedge& wedge) {
        return std::ranges::all_of(comparable(wedge), is_finite);
      })) {
    return bad_input(path.string(), "measures of its wedges are beyond all bounds",
                     "analyse its mesh again; see that its unit is right");
  }
  return file;
}

Result<Collection> Collection::open(const fs::path& folder, std::chrono::milliseconds settled) {
  Result<AnalysedFiles> found = analysed_files(folder);
  if (!found) {
    return std::unexpected(found.error());
  }
  const std::vector<fs::path>& paths = found->paths;
  Collection collection;
  collection.unread_ = std::move(found->unread);
  collection.lost_sessions_ = std::move(found->lost_sessions);
  const fs::path index_path = folder / kSearchIndexName;
  SearchIndex kept = read_index(index_path, &collection.remark_);
  std::map<std::string, IndexedTablet*> known;
  for (IndexedTablet& tablet : kept.tablets) {
    known[tablet.name] = &tablet;
  }
  const std::size_t before = kept.tablets.size();
  std::vector<IndexedTablet> tablets(paths.size());
  std::vector<std::size_t> to_read;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const fs::path& path = paths[i];
    const std::string name = path.lexically_relative(folder).string();
    const FileStamp stamp = stamp_of(path, settled);
    if (const auto it = known.find(name);
        it != known.end() && stamp != FileStamp{} && it->second->stamp == stamp) {
      tablets[i] = std::move(*it->second);
    } else {
      tablets[i].name = name;
      to_read.push_back(i);
    }
  }
  parallel_for_each_index(
      to_read.size(),
      [&](std::size_t k) {
        IndexedTablet& tablet = tablets[to_read[k]];
        tablet = read_tablet(paths[to_read[k]], std::string(tablet.name), settled);
      },
      1);
  if (std::ranges::all_of(tablets, [](const IndexedTablet& t) { return !t.complaint.empty(); })) {
    return bad_input(folder.string(), "no analysed tablet in it",
                     "write some with dubsar analyze MESH -o wedges.json");
  }
  const bool changed = !to_read.empty() || tablets.size() != before;
  collection.read_anew_ = to_read.size();
  collection.index_ = std::move(kept);
  collection.index_.tablets = std::move(tablets);
  if (collection.plant(changed) && !checked_folder_around(folder)) {
    const Status written = write_file_atomically(index_path, search_index_to_bytes(collection.index_));
    if (!written) {
      collection.remark_ = "the search index is not kept: " + written.error().line();
    }
  }
  return collection;
}

bool Collection::plant(bool anew) {
  std::vector<std::vector<float>> wedge_values;
  std::vector<std::vector<float>> tablet_values;
  for (std::size_t t = 0; t < index_.tablets.size(); ++t) {
    const IndexedTablet& tablet = index_.tablets[t];
    for (std::size_t w = 0; w < tablet.ids.size(); ++w) {
      const auto from = tablet.features.begin() + static_cast<std::ptrdiff_t>(w * index_.columns);
      wedge_rows_.push_back({t, w});
      wedge_values.emplace_back(from, from + index_.columns);
    }
    if (!tablet.profile.empty()) {
      tablet_rows_.push_back(t);
      tablet_values.push_back(tablet.profile);
    }
  }
  if (!anew) {
    wedges_ = FeatureSearch::with_tree(wedge_values, FeatureDistance::kL2, index_.wedge_tree);
    tablets_ = FeatureSearch::with_tree(tablet_values, FeatureDistance::kL1, index_.tablet_tree);
  }
  const bool made = !wedges_ || !tablets_;
  if (!wedges_) {
    wedges_.emplace(wedge_values, FeatureDistance::kL2);
    index_.wedge_tree = wedges_->tree();
  }
  if (!tablets_) {
    tablets_.emplace(tablet_values, FeatureDistance::kL1);
    index_.tablet_tree = tablets_->tree();
  }
  return made;
}

OtherMethods Collection::measured_otherwise(int method) const {
  OtherMethods out;
  for (const IndexedTablet& tablet : index_.tablets) {
    if (tablet.ids.empty()) {
      continue;
    }
    ++out.searched;
    if (tablet.method != method) {
      out.first = out.others == 0 ? &tablet : out.first;
      ++out.others;
    }
  }
  return out;
}

std::vector<SimilarWedge> Collection::similar_wedges(const Wedge& wedge, std::size_t count) const {
  const std::uint64_t itself = wedge_digest(wedge);
  std::vector<SimilarWedge> similar;
  for (const FeatureMatch& match : wedges_->nearest(comparable(wedge), count + kCopies)) {
    const Row& row = wedge_rows_[match.index];
    const IndexedTablet& tablet = index_.tablets[row.tablet];
    if (tablet.digests[row.wedge] != itself && similar.size() < count) {
      similar.push_back({tablet.name, tablet.ids[row.wedge], match.distance});
    }
  }
  return similar;
}

std::vector<SimilarTablet> Collection::similar_tablets(const WedgeFile& tablet, std::size_t count) const {
  std::vector<std::uint64_t> itself;
  for (const Wedge& wedge : tablet.wedges) {
    itself.push_back(wedge_digest(wedge));
  }
  std::vector<SimilarTablet> similar;
  for (const FeatureMatch& match : tablets_->nearest(comparable(tablet.wedges), count + kCopies)) {
    const IndexedTablet& other = index_.tablets[tablet_rows_[match.index]];
    if (other.digests != itself && similar.size() < count) {
      similar.push_back({other.name, static_cast<int>(other.ids.size()),
                         match.distance / static_cast<double>(kWedgeFeatures.size())});
    }
  }
  return similar;
}

}  // namespace dubsar
