// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a session keeps of scans that it has lost since: nobody can make it anew.

#include <algorithm>
#include <set>

#include "core/scan_list.h"
#include "formats/atomic_file.h"
#include "station/lost_scans.h"
#include "station/package_content.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// Whether the session's mesh was made of the scans that are lost and the others, in the places that they
/// have.
Result<bool> mesh_is_of_all(const PackageContent& content, const std::vector<StoredScan>& scans) {
  Result<std::vector<ScanPose>> poses = content.store.poses();
  if (!poses) {
    return std::unexpected(poses.error());
  }
  std::erase_if(*poses, [&](const ScanPose& pose) {
    const auto scan = std::ranges::find(scans, pose.id, &StoredScan::id);
    return scan == scans.end() || scan->dropped;
  });
  const auto mesh = stored_mesh_file(content.store, *poses, content.job);
  return mesh ? Result<bool>(mesh->has_value()) : std::unexpected(mesh.error());
}

/// What is to be said of the files.
Result<std::string> words_on(const PackageContent& content, const std::vector<StoredScan>& scans,
                             const std::string& lost) {
  const Result<bool> of_all = mesh_is_of_all(content, scans);
  if (!of_all) {
    return std::unexpected(of_all.error());
  }
  return *of_all ? "as the session keeps it, made while " + lost +
                       " could still be read: the only record of their surface"
                 : "as the session keeps it, made of other scans or places than those that are here, maybe "
                   "while " +
                       lost + " could still be read";
}

}  // namespace

Status add_kept(PackageContent& content) {
  const Result<std::vector<StoredScan>> scans = content.store.scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  const std::vector<int> lost = lost_scans(*scans);
  if (lost.empty()) {
    return {};
  }
  const auto of_the_rest = stored_mesh_file(content.store, content.results().poses, content.job);
  if (!of_the_rest) {
    return std::unexpected(of_the_rest.error());
  }
  if (*of_the_rest) {
    return {};  // the session's own mesh is the package's
  }
  const Result<std::string> words = words_on(content, *scans, listed(lost));
  if (!words) {
    return std::unexpected(words.error());
  }
  std::set<std::string> folders;
  for (const std::string& name : content.source.whole_files()) {
    const std::string folder = name.substr(0, name.find('/') + 1);
    if (folder != "mesh/" && folder != "analysis/" && folder != "export/") {
      continue;
    }
    const Result<std::string> bytes = read_whole_file(content.store.folder() / name);
    if (!bytes) {
      content.lacking.push_back("kept/" + name + " is not here: " + bytes.error().what + ".");
      continue;
    }
    const Result<fs::path> place = content.place("kept/" + name);
    if (!place) {
      return std::unexpected(place.error());
    }
    if (const Status written = write_file_atomically(*place, std::string_view(*bytes)); !written) {
      return written;
    }
    folders.insert("kept/" + fs::path(name).parent_path().generic_string() + "/");
  }
  for (const std::string& folder : folders) {
    content.list(folder,
                 (folder.starts_with("kept/mesh/")       ? "the mesh, "
                  : folder.starts_with("kept/analysis/") ? "the wedges of kept/mesh, "
                                                         : "the verdict of kept/mesh with its pages, ") +
                     *words);
  }
  const bool some_remain = !content.results().poses.empty();
  content.lacking.push_back(
      "Without " + listed(lost) +
      (some_remain ? " model, wedges, pictures, verdict and report are of the scans that remain"
                   : " there is nothing that a model could be made of, and verdict and report say so") +
      (folders.empty() ? "." : "; what was made while they could be read is in kept/."));
  return {};
}

}  // namespace dubsar
