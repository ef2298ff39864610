// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/bag_doubt.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include "formats/atomic_file.h"
#include "formats/grid_file.h"
#include "formats/json_node.h"
#include "formats/self_checked.h"

namespace dubsar {

namespace fs = std::filesystem;

namespace {

/// In how many places two texts differ; all of them where one is longer.
std::size_t places_apart(std::string_view a, std::string_view b) {
  return a.size() != b.size()
             ? std::max(a.size(), b.size())
             : std::transform_reduce(a.begin(), a.end(), b.begin(), std::size_t{0}, std::plus<>(),
                                     [](char one, char other) { return one == other ? 0U : 1U; });
}

/// By the path alone. What stands around the name is the next line, or what a blank among its digits took
/// from the checksum.
bool may_be_of(const BagManifestLine& line, const std::string& name) {
  return places_apart(line.path, name) == 1 || line.path.starts_with(name) || line.path.ends_with(name);
}

bool is_of(const BagManifestLine& line, const std::string& sum) {
  const std::size_t digits = line.sum.size();
  return line.sum == sum ||
         (digits < sum.size() && sum.starts_with(line.sum) && line.path.starts_with(sum.substr(digits + 1)));
}

/// Of a grid, or a text of a person's work. It tells accidents: who changes a file on purpose can write
/// another.
bool has_own_checksum_that_fits(const fs::path& file) {
  if (file.extension() == ".grid") {
    return verify_grid_file(file).has_value();
  }
  const Result<std::string> text =
      file.extension() == ".json" ? read_whole_file(file, kMaxJsonBytes) : std::string();
  return text && own_checksum_of(*text) == OwnChecksum::kFits;
}

/// One by which the file is whole; empty where there is none.
std::string list_that_fits(const fs::path& folder, const std::vector<BagManifest>& group,
                           const std::string& path, const JobContext& job) {
  for (const BagManifest& manifest : group) {
    const auto line = std::ranges::find(manifest.lines, path, &BagManifestLine::path);
    const bool proves = manifest.digest != Digest::kMd5 && manifest.digest != Digest::kSha1;
    if (proves && line != manifest.lines.end() &&
        digest_of_file(manifest.digest, folder / path, job) == line->sum) {
      return manifest.name;
    }
  }
  return {};
}

}  // namespace

bool is_damaged_sum(std::string_view listed, std::string_view of_file) {
  return places_apart(listed, of_file) <= of_file.size() / 4 || listed.starts_with(of_file);
}

std::optional<DoubtfulLine> doubt_of_line(const fs::path& folder, const std::vector<BagManifest>& group,
                                          const BagManifestLine& line, const std::string& sum,
                                          bool list_is_whole, const JobContext& job) {
  if (is_damaged_sum(line.sum, sum)) {
    const std::size_t others =
        line.sum.size() > sum.size() ? line.sum.size() - sum.size() : places_apart(line.sum, sum);
    return DoubtfulLine{"is damaged: of the checksum of " + line.path + " " + std::to_string(others) +
                            " of " + std::to_string(line.sum.size()) +
                            " digits are others, and the file is whole",
                        true};
  }
  if (list_is_whole) {
    return std::nullopt;
  }
  if (const std::string other = list_that_fits(folder, group, line.path, job); !other.empty()) {
    return DoubtfulLine{
        "is damaged: it has another checksum than " + line.path + ", which is whole by " + other, true};
  }
  if (has_own_checksum_that_fits(folder / line.path)) {
    return DoubtfulLine{"has another checksum than " + line.path +
                            ", whose own fits: the line is damaged, or somebody changed the file on purpose",
                        false};
  }
  return std::nullopt;
}

std::optional<std::string> file_meant(const fs::path& folder, const std::set<std::string>& files,
                                      const BagManifest& manifest, const BagManifestLine& line,
                                      const JobContext& job) {
  for (const std::string& name : files) {
    if (!may_be_of(line, name) ||
        std::ranges::find(manifest.lines, name, &BagManifestLine::path) != manifest.lines.end()) {
      continue;
    }
    const Result<std::string> sum = digest_of_file(manifest.digest, folder / name, job);
    if (sum && is_of(line, *sum)) {
      return name;
    }
  }
  return std::nullopt;
}

}  // namespace dubsar
