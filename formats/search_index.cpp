// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/search_index.h"

#include <xxhash.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "formats/byte_order.h"

namespace dubsar {

namespace {

constexpr std::string_view kMagic = "DUBSIDX5";
constexpr std::size_t kHeadBytes = 16;  // magic, digest of all that follows
constexpr std::uint32_t kMostColumns = 4096;

void put_text(std::string& to, std::string_view text) {
  append(to, static_cast<std::uint64_t>(text.size()));
  to += text;
}

template <class T>
void put_all(std::string& to, const std::vector<T>& values) {
  append(to, static_cast<std::uint64_t>(values.size()));
  for (const T value : values) {
    append(to, value);
  }
}

/// Takes values off the front; once too few bytes are left everything reads as nothing.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : left_(bytes) {}
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool at_end() const { return left_.empty(); }

  template <class T>
  T value() {
    const std::string_view bytes = take(sizeof(T));
    return bytes.empty() ? T{} : load<T>(bytes.data());
  }
  std::string text() { return std::string(take(value<std::uint64_t>())); }
  template <class T>
  std::vector<T> all() {
    const auto count = value<std::uint64_t>();
    if (count > left_.size() / sizeof(T)) {
      good_ = false;
      return {};
    }
    const std::string_view bytes = take(count * sizeof(T));
    std::vector<T> values(bytes.size() / sizeof(T));
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = load<T>(bytes.data() + i * sizeof(T));
    }
    return values;
  }

 private:
  std::string_view take(std::uint64_t count) {
    if (!good_ || count > left_.size()) {
      good_ = false;
      return {};
    }
    const std::string_view taken = left_.substr(0, count);
    left_.remove_prefix(count);
    return taken;
  }
  std::string_view left_;
  bool good_ = true;
};

bool all_finite(const std::vector<float>& values) {
  for (const float value : values) {
    if (!std::isfinite(value)) {
      return false;
    }
  }
  return true;
}

IndexedTablet read_tablet(Reader& from) {
  IndexedTablet t;
  t.name = from.text();
  t.stamp = {from.value<std::uint64_t>(), from.value<std::uint64_t>(), from.value<std::uint64_t>(),
             from.value<std::int64_t>(), from.value<std::int64_t>()};
  t.complaint = from.text();
  t.method = from.value<std::int32_t>();
  t.ids = from.all<std::int32_t>();
  t.digests = from.all<std::uint64_t>();
  t.features = from.all<float>();
  t.profile = from.all<float>();
  return t;
}

bool consistent(const SearchIndex& index, const IndexedTablet& t) {
  return t.digests.size() == t.ids.size() && t.features.size() == t.ids.size() * index.columns &&
         (t.profile.empty() || t.profile.size() == index.profile_columns) && all_finite(t.features) &&
         all_finite(t.profile);
}

}  // namespace

std::uint64_t wedge_digest(const Wedge& wedge) {
  std::string bytes;
  const auto put = [&](const Eigen::Vector3d& p) {
    for (const double value : {p.x(), p.y(), p.z()}) {
      append(bytes, value + 0.0);  // minus zero is zero
    }
  };
  put(wedge.depth_point_mm);
  for (const Eigen::Vector3d& exit : wedge.exit_points_mm) {
    put(exit);
  }
  return XXH64(bytes.data(), bytes.size(), 0);
}

std::string search_index_to_bytes(const SearchIndex& index) {
  std::string body;
  append(body, index.columns);
  append(body, index.profile_columns);
  append(body, static_cast<std::uint64_t>(index.tablets.size()));
  for (const IndexedTablet& t : index.tablets) {
    put_text(body, t.name);
    append(body, t.stamp.size);
    append(body, t.stamp.device);
    append(body, t.stamp.inode);
    append(body, t.stamp.modified_ns);
    append(body, t.stamp.changed_ns);
    put_text(body, t.complaint);
    append(body, t.method);
    put_all(body, t.ids);
    put_all(body, t.digests);
    put_all(body, t.features);
    put_all(body, t.profile);
  }
  put_text(body, index.wedge_tree);
  put_text(body, index.tablet_tree);
  std::string bytes(kMagic);
  append(bytes, static_cast<std::uint64_t>(XXH64(body.data(), body.size(), 0)));
  return bytes + body;
}

Result<SearchIndex> parse_search_index(std::string_view bytes, const std::string& where) {
  const auto damaged = [&](const char* how) { return bad_input(where, how, "delete it: it is made again"); };
  if (bytes.size() < kHeadBytes || bytes.substr(0, kMagic.size()) != kMagic) {
    return damaged("no search index of this version");
  }
  const std::string_view body = bytes.substr(kHeadBytes);
  if (load<std::uint64_t>(bytes.data() + kMagic.size()) != XXH64(body.data(), body.size(), 0)) {
    return damaged("a damaged search index: its checksum is wrong");
  }
  Reader from(body);
  SearchIndex index;
  index.columns = from.value<std::uint32_t>();
  index.profile_columns = from.value<std::uint32_t>();
  const auto count = from.value<std::uint64_t>();
  if (index.columns > kMostColumns || index.profile_columns > kMostColumns) {
    return damaged("a damaged search index: too many features");
  }
  for (std::uint64_t i = 0; i < count && from.good(); ++i) {
    index.tablets.push_back(read_tablet(from));
    if (!consistent(index, index.tablets.back())) {
      return damaged("a damaged search index: a tablet's numbers do not fit together");
    }
  }
  index.wedge_tree = from.text();
  index.tablet_tree = from.text();
  if (!from.good() || !from.at_end()) {
    return damaged("a damaged search index: it ends too early or too late");
  }
  return index;
}

}  // namespace dubsar
