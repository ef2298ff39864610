// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/job.h"
#include "formats/bag_text.h"
#include "formats/digest.h"

/// What is in doubt where a file of a bag is not what a manifest says: the file, or that line of the
/// manifest.
namespace dubsar {

struct BagManifest {
  std::string name;
  std::string algorithm;  ///< as its name has it
  Digest digest;
  std::vector<BagManifestLine> lines;
};

/// Whether the listed checksum was that of the file before some of its digits were damaged, or a blank behind
/// them: no more than a quarter of them are others, or some follow. Of other bytes 15 of 16 are; a quarter at
/// most, with the 32 digits of MD5, once in 10²¹ pairs.
[[nodiscard]] bool is_damaged_sum(std::string_view listed, std::string_view of_file);

struct DoubtfulLine {
  std::string what;  ///< "is damaged: …"
  bool file_is_whole = false;
};
/// Of a file that has the checksum `sum` and not the line's. By its digits the line may be a damaged one of
/// this file; and unless a tag manifest says that the list is whole, another of the group (SHA-2; MD5 and
/// SHA-1 prove nothing against a better one), or the checksum that grids and a person's work carry
/// themselves, may speak for the file. Nothing where the file is in doubt.
[[nodiscard]] std::optional<DoubtfulLine> doubt_of_line(const std::filesystem::path& folder,
                                                        const std::vector<BagManifest>& group,
                                                        const BagManifestLine& line, const std::string& sum,
                                                        bool list_is_whole, const JobContext& job);

/// Of a line that names what is not here: the file among these that it was of, which the manifest does not
/// list. It has the line's checksum, and one character of its name, of the checksum (a blank) or at the
/// line's end is another.
[[nodiscard]] std::optional<std::string> file_meant(const std::filesystem::path& folder,
                                                    const std::set<std::string>& files,
                                                    const BagManifest& manifest, const BagManifestLine& line,
                                                    const JobContext& job);

}  // namespace dubsar
