// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/collection.h"

#include <algorithm>
#include <system_error>

#include "analysis/feature_search.h"
#include "analysis/wedge_features.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

constexpr int kFewestWedges = 5;
/// The wedge that is searched by may be in the collection more than once.
constexpr std::size_t kCopies = 16;

bool same_place(const Wedge& a, const Wedge& b) {
  return a.depth_point_mm == b.depth_point_mm && a.exit_points_mm == b.exit_points_mm;
}

bool same_wedges(const std::vector<Wedge>& a, const std::vector<Wedge>& b) {
  return std::ranges::equal(a, b, same_place);
}

}  // namespace

Result<Collection> read_collection(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> paths;
  for (fs::recursive_directory_iterator it(folder, fs::directory_options::skip_permission_denied, error), end;
       !error && it != end; it.increment(error)) {
    std::error_code no_file;
    if (it->path().extension() == ".json" && it->path().filename() != "truth.json" &&
        it->is_regular_file(no_file)) {
      paths.push_back(it->path());
    }
  }
  if (error) {
    return bad_input(folder.string(), "cannot read the folder: " + error.message(), "check the name");
  }
  std::ranges::sort(paths);
  Collection collection;
  for (const fs::path& path : paths) {
    Result<WedgeFile> file = read_wedges(path);
    if (file) {
      collection.tablets.push_back({fs::relative(path, folder, error).string(), *std::move(file)});
    } else {
      collection.skipped.push_back(file.error().line());
    }
  }
  if (collection.tablets.empty()) {
    return bad_input(folder.string(), "no analysed tablet in it",
                     "write some with dubsar analyze MESH -o wedges.json");
  }
  return collection;
}

std::vector<SimilarWedge> similar_wedges(const Collection& collection, const Wedge& wedge,
                                         std::size_t count) {
  struct Row {
    std::size_t tablet, wedge;
  };
  std::vector<Row> rows;
  std::vector<std::vector<float>> values;
  for (std::size_t t = 0; t < collection.tablets.size(); ++t) {
    const std::vector<Wedge>& wedges = collection.tablets[t].file.wedges;
    for (std::size_t w = 0; w < wedges.size(); ++w) {
      rows.push_back({t, w});
      values.push_back(comparable(wedge_features(wedges[w])));
    }
  }
  const FeatureSearch search(values, FeatureDistance::kL2);
  std::vector<SimilarWedge> similar;
  for (const FeatureMatch& match : search.nearest(comparable(wedge_features(wedge)), count + kCopies)) {
    const Collection::Tablet& tablet = collection.tablets[rows[match.index].tablet];
    const Wedge& other = tablet.file.wedges[rows[match.index].wedge];
    if (!same_place(other, wedge) && similar.size() < count) {
      similar.push_back({tablet.name, other.id, match.distance});
    }
  }
  return similar;
}

std::vector<SimilarTablet> similar_tablets(const Collection& collection, const std::vector<Wedge>& wedges,
                                           std::size_t count) {
  std::vector<std::size_t> rows;
  std::vector<std::vector<float>> values;
  for (std::size_t t = 0; t < collection.tablets.size(); ++t) {
    const WedgeProfile profile = make_profiles(collection.tablets[t].file.wedges).front();
    if (profile.count >= kFewestWedges && !same_wedges(collection.tablets[t].file.wedges, wedges)) {
      rows.push_back(t);
      values.push_back(comparable(profile));
    }
  }
  const FeatureSearch search(values, FeatureDistance::kL1);
  std::vector<SimilarTablet> similar;
  for (const FeatureMatch& match : search.nearest(comparable(make_profiles(wedges).front()), count)) {
    const Collection::Tablet& tablet = collection.tablets[rows[match.index]];
    similar.push_back({tablet.name, static_cast<int>(tablet.file.wedges.size()),
                       match.distance / static_cast<double>(kWedgeFeatures.size())});
  }
  return similar;
}

}  // namespace dubsar
