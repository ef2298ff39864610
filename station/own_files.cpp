// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/own_files.h"

#include <string_view>

#include "archive/file_address.h"
#include "formats/atomic_file.h"
#include "formats/bag_check.h"
#include "formats/json_node.h"
#include "station/package_content.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

Result<std::set<std::string>> as_the_stamp_has_them(const fs::path& package, const DoneStamp& stamp,
                                                    const JobContext& job) {
  std::set<std::string> own;
  for (const StampedFile& written : stamp.outputs) {
    // "PACKAGE/data/README.txt": by whatever name the package goes now.
    const std::string name = written.name.substr(written.name.find('/') + 1);
    std::error_code error;
    if (!fs::is_regular_file(fs::symlink_status(package / name, error)) ||
        fs::file_size(package / name, error) != written.bytes || error) {
      continue;
    }
    const Result<StampedFile> there = stamped_file(package / name, written.name, job);
    if (!there && there.error().kind == ErrorKind::kCancelled) {
      return std::unexpected(there.error());
    }
    if (there && *there == written) {
      own.insert(name);
    }
  }
  return own;
}

/// What the provenance of a package says was made, below the payload's folder.
std::set<std::string> made_by_provenance(const std::string& text) {
  constexpr std::string_view kOwnName = "provenance.jsonld";
  std::set<std::string> made;
  const Result<JsonDocument> document = JsonDocument::parse(text, std::string(kOwnName));
  if (!document) {
    return made;
  }
  std::string base;  // of every address; it describes itself first
  const auto add = [&](const std::string& id) {
    if (!base.empty() && id.starts_with(base)) {
      made.insert(path_of_address(std::string_view(id).substr(base.size())));
    }
  };
  for (const JsonNode& node : document->root().at("@graph").items()) {
    if (const std::string id = node.at("@id").text(); base.empty() && id.ends_with(kOwnName)) {
      base = id.substr(0, id.size() - kOwnName.size());
      add(id);
    }
    if (const auto grid = node.find("crmdig:L20_has_created")) {
      add(grid->at("@id").text());
    }
    if (const auto files = node.find("crmdig:L22_created_derivative")) {
      for (const JsonNode& file : files->items()) {
        add(file.at("@id").text());
      }
    }
  }
  return made;
}

std::set<std::string> as_the_package_lists_them(const fs::path& package) {
  std::set<std::string> names{"bagit.txt", "manifest-sha512.txt"};
  for (const FormatText& page : format_texts()) {
    names.insert(std::string("data/formats/") + page.name);
  }
  const Result<std::string> text = read_whole_file(package / "data/provenance.jsonld", kMaxJsonBytes);
  for (const std::string& made : made_by_provenance(text.value_or(std::string()))) {
    names.insert("data/" + made);
  }
  return names;
}

}  // namespace

Result<std::set<std::string>> own_files_of(const fs::path& package, const std::optional<DoneStamp>& stamp,
                                           JobContext& job) {
  if (!is_bag(package)) {
    return std::set<std::string>();
  }
  if (stamp) {
    return as_the_stamp_has_them(package, *stamp, job);
  }
  const Result<BagReport> report = check_bag(package, job);
  if (!report) {
    return std::unexpected(report.error());
  }
  const std::set<std::string> listed = as_the_package_lists_them(package);
  std::set<std::string> own{"tagmanifest-sha512.txt"};  // the last that is written: no manifest lists it
  for (const std::string& name : report->whole) {
    if (listed.contains(name)) {
      own.insert(name);
    }
  }
  return own;
}

}  // namespace dubsar
