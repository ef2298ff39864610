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

/// The session's mesh is the package's model, in the package's forms.
Result<bool> mesh_is_the_model(const PackageContent& content) {
  const auto mesh = stored_mesh_file(content.store, content.results().poses, content.job);
  return mesh ? Result<bool>(mesh->has_value()) : std::unexpected(mesh.error());
}

/// Names whole files of the session in whose place others are packed, each kind with why.
Status add_stale(PackageContent& content) {
  if (content.source.pages()) {
    return {};
  }
  const Result<bool> same_mesh = mesh_is_the_model(content);
  if (!same_mesh) {
    return std::unexpected(same_mesh.error());
  }
  const bool same_wedges = content.wedges_are_kept || (*same_mesh && !content.has(PackagePart::kWedges));
  std::vector<std::string> pages;
  std::vector<std::string> others;
  for (const std::string& name : content.source.found().whole) {
    std::error_code unknown;
    if (!is_derived(name) || is_by_hand(name) || fs::exists(content.root / "kept" / name, unknown)) {
      continue;
    }
    if (name.starts_with("export/")) {
      pages.push_back(name);
    } else if (!(name.starts_with("mesh/") ? *same_mesh : same_wedges)) {
      others.push_back(name);
    }
  }
  const auto tell = [&](const std::vector<std::string>& names, const std::string& why) {
    if (!names.empty()) {
      content.left_out.push_back("As the session keeps them these are not here" + why +
                                 "; what is here of the kind was worked out anew: " + file_list(names) + ".");
    }
  };
  const std::string& why = content.source.why_anew();
  tell(pages, why.empty() ? why : " (" + why + ")");
  tell(others, ", for they are not of the scans and places that are here, or another version made them");
  return {};
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
  if (const Status told = add_stale(content); !told) {
    return told;
  }
  if (!found.set_aside.empty()) {
    content.left_out.push_back(
        "Originals that were set aside in the session when it was mended are not here: " +
        file_list(found.set_aside) + ".");
  }
  if (!found.extra.empty()) {
    content.left_out.push_back("In the session's folder lies what is no part of it, and is not here: " +
                               file_list(found.extra) + ".");
  }
  return {};
}

}  // namespace dubsar
