// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/search_index.h"

#include <gtest/gtest.h>

namespace dubsar {
namespace {

SearchIndex two_tablets() {
  SearchIndex index;
  index.columns = 2;
  index.profile_columns = 3;
  IndexedTablet a;
  a.name = "a/wedges.json";
  a.stamp = {1, 2, 3, 4, -5};
  a.method = 4;
  a.ids = {0, 7};
  a.digests = {11, 12};
  a.features = {1, 2, 3, 4};
  a.profile = {5, 6, 7};
  IndexedTablet b;
  b.name = "note.json";
  b.complaint = "note.json: wedges is missing";
  index.tablets = {a, b};
  index.wedge_tree = "a tree";
  return index;
}

TEST(SearchIndexBytes, ReadBackAsTheyWere) {
  const std::string bytes = search_index_to_bytes(two_tablets());
  const auto back = parse_search_index(bytes, "i");
  ASSERT_TRUE(back) << back.error().line();
  ASSERT_EQ(back->tablets.size(), 2U);
  EXPECT_EQ(back->tablets[0].name, "a/wedges.json");
  EXPECT_EQ(back->tablets[0].method, 4);
  EXPECT_EQ(back->tablets[0].stamp, (FileStamp{1, 2, 3, 4, -5}));
  EXPECT_EQ(back->tablets[0].features, (std::vector<float>{1, 2, 3, 4}));
  EXPECT_EQ(back->tablets[1].complaint, "note.json: wedges is missing");
  EXPECT_EQ(back->wedge_tree, "a tree");
  EXPECT_EQ(search_index_to_bytes(*back), bytes);
}

TEST(SearchIndexBytes, DamageIsNoticedWhereverItIs) {
  const std::string bytes = search_index_to_bytes(two_tablets());
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    EXPECT_FALSE(parse_search_index(damaged, "i")) << at;
    EXPECT_FALSE(parse_search_index(bytes.substr(0, at), "i")) << at;
  }
  EXPECT_FALSE(parse_search_index(bytes + '\0', "i"));
}

TEST(SearchIndexBytes, NumbersThatDoNotFitTogetherAreRefused) {
  SearchIndex index = two_tablets();
  index.tablets[0].features.pop_back();
  EXPECT_FALSE(parse_search_index(search_index_to_bytes(index), "i"));
  index = two_tablets();
  index.tablets[0].digests.pop_back();
  EXPECT_FALSE(parse_search_index(search_index_to_bytes(index), "i"));
  index = two_tablets();
  index.tablets[0].profile[0] = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(parse_search_index(search_index_to_bytes(index), "i"));
}

TEST(WedgeDigest, TellsWedgesApartByTheirPlace) {
  Wedge a;
  Wedge b;
  b.id = 4;
  b.exit_points_mm[2].x() = -0.0;
  EXPECT_EQ(wedge_digest(a), wedge_digest(b));
  b.exit_points_mm[2].x() = 1e-9;
  EXPECT_NE(wedge_digest(a), wedge_digest(b));
}

}  // namespace
}  // namespace dubsar
