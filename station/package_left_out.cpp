// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What lies in the session's folder and is not packed, by name: nobody shall have to guess.

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "core/utf8.h"
#include "formats/files_below.h"
#include "station/file_list.h"
#include "station/package_content.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// It, or a folder that it lies in, is one of them.
bool lies_in(const std::string& name, const std::vector<std::string>& folders) {
  return std::ranges::any_of(
      folders, [&](const std::string& folder) { return name == folder || name.starts_with(folder + "/"); });
}

}  // namespace

bool is_derived(const std::string& name) {
  return name.starts_with("mesh/") || name.starts_with("analysis/") || name.starts_with("export/");
}

Status add_left_out(PackageContent& content) {
  const VerifyReport& found = content.source.found();
  const fs::path& session = content.store.folder();
  std::vector<std::string> closed;  // add_unreadable() names them
  for (const Error& folder : everything_below(session).unreadable) {
    closed.push_back(fs::path(folder.where).lexically_relative(session).generic_string());
  }
  for (const Error& damage : found.damaged) {
    if (is_derived(damage.where) && !is_by_hand(damage.where) && !lies_in(damage.where, closed)) {
      content.left_out.push_back(
          fmt::format("{} of the session is not here: {}. What is here of the kind was worked out anew.",
                      one_line(damage.where), damage.what));
    }
  }
  const auto was_kept = [&](const std::string& name) {
    std::error_code unknown;
    return fs::exists(content.root / "kept" / name, unknown);
  };
  std::vector<std::string> stale;
  for (const std::string& name : found.whole) {
    if (!content.source.pages() && is_derived(name) && !is_by_hand(name) && !was_kept(name)) {
      stale.push_back(name);
    }
  }
  if (!stale.empty()) {
    content.left_out.push_back(
        "As the session keeps them these are not here, for they are not all of the scans as they "
        "stand; what is here of the kind was worked out anew: " +
        file_list(stale) + ".");
  }
  if (!found.set_aside.empty()) {
    content.left_out.push_back(
        "Damaged originals that were set aside in the session when it was mended are not here: " +
        file_list(found.set_aside) + ".");
  }
  if (!found.extra.empty()) {
    content.left_out.push_back("In the session's folder lies what is no part of it, and is not here: " +
                               file_list(found.extra) + ".");
  }
  return {};
}

}  // namespace dubsar
