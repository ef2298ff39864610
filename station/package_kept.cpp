// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a session keeps of scans that it has lost since, and what lies in it without a record: nobody can make
// it anew.

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/scan_list.h"
#include "core/utf8.h"
#include "formats/atomic_file.h"
#include "station/file_list.h"
#include "station/lost_scans.h"
#include "station/package_content.h"
#include "station/session_pages.h"

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

/// "kept/mesh/" and the like.
std::string kept_folder(const std::string& name) {
  return "kept/" + fs::path(name).parent_path().generic_string() + "/";
}

const char* kind_of(const std::string& kept_folder) {
  return kept_folder.starts_with("kept/mesh/")       ? "the mesh, "
         : kept_folder.starts_with("kept/analysis/") ? "the wedges of kept/mesh, "
                                                     : "the verdict of kept/mesh with its pages, ";
}

/// False where the file cannot be read, which is told.
Result<bool> keep(PackageContent& content, const std::string& name) {
  const Result<std::string> bytes = read_whole_file(content.store.folder() / name);
  if (!bytes) {
    content.lacking.push_back("kept/" + one_line(name) + " is not here: " + bytes.error().what + ".");
    return false;
  }
  const Result<fs::path> place = content.place("kept/" + name);
  if (!place) {
    return std::unexpected(place.error());
  }
  const Status written = write_file_atomically(*place, std::string_view(*bytes));
  return written ? Result<bool>(true) : std::unexpected(written.error());
}

/// Whether the session has lost some of its record. A file may lie in one that has not, too: somebody put it
/// there.
bool has_lost_of_its_record(const PackageContent& content) {
  return !content.source.found().lost.empty() || !damage_of_record(content.store).empty();
}

/// Packs what was made of scans among these files of the session, a person's own work apart. Where each went,
/// by folder of the package.
Result<std::map<std::string, std::vector<std::string>>> keep_derived(PackageContent& content,
                                                                     const std::vector<std::string>& names) {
  std::map<std::string, std::vector<std::string>> folders;
  for (const std::string& name : names) {
    if (!is_derived(name) || is_by_hand(name)) {
      continue;
    }
    if (name.starts_with("export/") && pages_are_taken_back(content.store)) {
      continue;  // it says that the session was changed, and nothing of the scans
    }
    const Result<bool> kept = keep(content, name);
    if (!kept) {
      return std::unexpected(kept.error());
    }
    if (*kept) {
      folders[kept_folder(name)].push_back(name);
    }
  }
  return folders;
}

/// What lies in the session and has no record any more, the mesh and the signed pages maybe among it.
Status keep_unrecorded(PackageContent& content) {
  const auto folders = keep_derived(content, content.source.found().unrecorded);
  if (!folders) {
    return std::unexpected(folders.error());
  }
  std::vector<std::string> all;
  for (const auto& [folder, files] : *folders) {
    std::vector<std::string> names;
    for (const std::string& file : files) {
      names.push_back(fs::path(file).filename().string());
      all.push_back(file);
    }
    content.list(folder,
                 file_list(names) +
                     ": as they lie in the session, which has no record of them: no checksum was kept, so "
                     "that nobody can tell whether they are what was stored");
  }
  if (!all.empty()) {
    const std::string files = file_list(all);
    content.lacking.push_back(
        has_lost_of_its_record(content)
            ? "The session has no record of these files, which are in kept/ as they lie there, unchecked: " +
                  files +
                  ". What else it once had on record, places of scans and signatures maybe among it, is not "
                  "here."
            : "These files lie in the session without a record of it, and are in kept/ as they lie there, "
              "unchecked: " +
                  files + ".");
  }
  return {};
}

Status keep_what_was_made_of_lost(PackageContent& content, const std::vector<StoredScan>& scans,
                                  const std::vector<int>& lost) {
  const Result<std::string> words = words_on(content, scans, listed(lost));
  if (!words) {
    return std::unexpected(words.error());
  }
  const auto folders = keep_derived(content, content.source.found().whole);
  if (!folders) {
    return std::unexpected(folders.error());
  }
  for (const auto& [folder, files] : *folders) {
    content.list(folder, kind_of(folder) + *words);
  }
  const bool some_remain = !content.results().poses.empty();
  content.lacking.push_back(
      "Without " + listed(lost) +
      (some_remain ? " model, wedges, pictures, verdict and report are of the scans that remain"
                   : " there is nothing that a model could be made of, and verdict and report say so") +
      (folders->empty() ? "." : "; what was made while they could be read is in kept/."));
  return {};
}

/// The pages that the latest signature stands on, where it holds and others are packed in their place: nobody
/// signed those.
Status keep_signed_pages(PackageContent& content) {
  const auto& signed_off = content.results().checklist.sign_off;
  const std::vector<std::string>& whole = content.source.found().whole;
  const std::string page = "export/checklist.html";
  if (content.source.pages() || !signed_off || !signed_off->holds() ||
      std::ranges::find(whole, page) == whole.end()) {
    return {};
  }
  const Result<std::string> text = read_whole_file(content.store.folder() / page);
  if (!text || text->find(signed_off->sign_off.digest) == std::string::npos) {
    return {};
  }
  std::vector<std::string> pages;
  std::ranges::copy_if(whole, std::back_inserter(pages),
                       [](const std::string& name) { return name.starts_with("export/"); });
  const auto folders = keep_derived(content, pages);
  if (!folders) {
    return std::unexpected(folders.error());
  }
  for (const auto& [folder, files] : *folders) {
    content.list(folder,
                 "the verdict and its pages as they were signed, as the session keeps them; those in "
                 "report/ were made anew, for " +
                     content.source.why_anew());
  }
  return {};
}

}  // namespace

Status add_kept(PackageContent& content) {
  const Result<std::vector<StoredScan>> scans = content.store.scans();
  if (!scans) {
    return std::unexpected(scans.error());
  }
  const Status unrecorded = keep_unrecorded(content);
  const std::vector<int> lost = lost_scans(*scans);
  if (!unrecorded || lost.empty()) {
    return unrecorded ? keep_signed_pages(content) : unrecorded;
  }
  const auto of_the_rest = stored_mesh_file(content.store, content.results().poses, content.job);
  if (!of_the_rest) {
    return std::unexpected(of_the_rest.error());
  }
  // Else the session's own mesh is the package's.
  return *of_the_rest ? Status() : keep_what_was_made_of_lost(content, *scans, lost);
}

}  // namespace dubsar
