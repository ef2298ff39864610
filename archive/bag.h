// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/job.h"
#include "core/result.h"

namespace dubsar {

/// One line of bag-info.txt, such as {"External-Identifier", "P123456"}. Line breaks in a value become
/// blanks; one without a value is left out.
struct BagField {
  std::string label;
  std::string value;
};

/// What a bag holds.
struct BagSize {
  std::uint64_t files = 0;  ///< of the payload
  std::uint64_t bytes = 0;  ///< likewise
};

/// Makes a folder whose payload lies in `data/` a bag (BagIt 1.0, RFC 8493): writes bagit.txt, bag-info.txt
/// (the fields, then Bag-Size and Payload-Oxum), manifest-sha512.txt over every file of the payload and
/// tagmanifest-sha512.txt over every other file. Every byte is read back from the disk for it. Lines are in
/// the order of the names. Errors: kBadInput without a payload or with something in it that is neither file
/// nor folder, kStorage, kCancelled.
[[nodiscard]] Result<BagSize> write_bag_tags(const std::filesystem::path& folder,
                                             const std::vector<BagField>& info, const JobContext& job);

/// A file name as a manifest has it: `%`, carriage return and line feed percent-encoded (RFC 8493, 2.1.3).
[[nodiscard]] std::string bag_path(std::string_view path);

/// "1.4 GB"
[[nodiscard]] std::string size_in_words(std::uint64_t bytes);

}  // namespace dubsar
