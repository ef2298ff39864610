// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/selections_json.h"

#include <algorithm>
#include <limits>

#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "formats/json_text.h"
#include "formats/self_checked.h"
#include "formats/xxh128.h"

namespace dubsar {

namespace {

const std::vector<std::string> kElements = {"faces", "vertices"};

/// Ranges as they must be: what is read is what was written.
std::vector<IndexRange> ranges_from(const JsonNode& node) {
  constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max();
  std::vector<IndexRange> ranges;
  std::int64_t least = 0;
  for (const JsonNode& entry : node.items()) {
    if (entry.size() != 2) {
      entry.complain("is not a first number and how many");
      break;
    }
    const std::int64_t first = entry.item(0).integer(0, kMost - 1);
    const std::int64_t count = entry.item(1).integer(1, kMost - first);
    if (first < least) {
      entry.complain("does not come after the one before");
    }
    if (node.failed()) {
      break;
    }
    ranges.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)});
    least = first + count + 1;
  }
  return ranges;
}

}  // namespace

std::string surface_digest(const Mesh& mesh) {
  Xxh128 sum;
  const auto add = [&](const auto& values) {
    const std::uint64_t count = values.size();
    sum.add(&count, sizeof count);
    sum.add(values.data(), count * sizeof(values.front()));
  };
  add(mesh.positions);
  add(mesh.faces);
  return sum.hex();
}

std::string selections_to_json(const SelectionFile& file) {
  OrderedJson root;
  root["mesh"] = file.mesh;
  root["surface_xxh128"] = file.surface_xxh128;
  root["selections"] = OrderedJson::array();
  for (const MeshSelection& selection : file.selections) {
    OrderedJson json;
    json["name"] = selection.name;
    json["of"] = kElements[static_cast<std::size_t>(selection.of)];
    json["ranges"] = OrderedJson::array();
    for (const IndexRange& range : selection.ranges) {
      json["ranges"].push_back({range.first, range.count});
    }
    root["selections"].push_back(std::move(json));
  }
  return root.dump(-1, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

Status write_selections(const std::filesystem::path& path, const SelectionFile& file) {
  const std::string text = with_own_checksum(selections_to_json(file));
  if (text.size() > kMaxJsonBytes) {
    return fail(ErrorKind::kBadInput, "the selections are in too many pieces to be kept", path.string(),
                "forget some of them, or keep the part as a mesh of its own");
  }
  return write_file_atomically(path, text);
}

Result<SelectionFile> parse_selections(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = parse_self_checked(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  root.only({"mesh", "surface_xxh128", "selections", kOwnChecksum});
  SelectionFile file;
  file.mesh = root.at("mesh").text();
  file.surface_xxh128 = root.at("surface_xxh128").text();
  for (const JsonNode& node : root.at("selections").items()) {
    node.only({"name", "of", "ranges"});
    MeshSelection selection;
    selection.name = node.at("name").text();
    selection.of = static_cast<MeshElement>(node.at("of").one_of(kElements));
    selection.ranges = ranges_from(node.at("ranges"));
    if (std::ranges::find(file.selections, selection.name, &MeshSelection::name) != file.selections.end()) {
      node.complain("has the name of another");
    }
    if (root.failed()) {
      break;
    }
    file.selections.push_back(std::move(selection));
  }
  if (Status status = document->status("see docs/formats/selections.md"); !status) {
    return std::unexpected(status.error());
  }
  return file;
}

Result<SelectionFile> read_selections(const std::filesystem::path& path) {
  const Result<std::string> text = read_whole_file(path, kMaxJsonBytes);
  return text ? parse_selections(*text, path.string()) : std::unexpected(text.error());
}

}  // namespace dubsar
