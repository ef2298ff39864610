// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/corrections_json.h"

#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "formats/json_text.h"
#include "formats/self_checked.h"
#include "formats/writers_turn.h"
#include "formats/xxh128.h"

namespace dubsar {

namespace {

const std::vector<std::string> kKinds = {"delete", "merge", "split", "add"};

using Places = std::vector<Eigen::Vector3d>;

OrderedJson places_json(const Places& places) {
  OrderedJson json = OrderedJson::array();
  for (const Eigen::Vector3d& place : places) {
    json.push_back(json_of(place));
  }
  return json;
}

Places places_from(const JsonNode& node, double mm, std::size_t least) {
  Places places;
  for (const JsonNode& entry : node.items()) {
    places.push_back(mm * entry.vector3());
  }
  if (places.size() < least) {
    node.complain("has " + std::to_string(places.size()) + " places, fewer than " + std::to_string(least));
  }
  return places;
}

WedgeCorrection correction_from(const JsonNode& node, double mm) {
  node.only({"do", "at", "into", "region", "reach"});
  WedgeCorrection out;
  out.kind = static_cast<CorrectionKind>(node.at("do").one_of(kKinds));
  if (out.kind == CorrectionKind::kAdd) {
    out.region_mm = places_from(node.at("region"), mm, 1);
    out.reach_mm = mm * node.at("reach").number(1e-6, 1e6);
    return out;
  }
  out.at_mm = places_from(node.at("at"), mm, out.kind == CorrectionKind::kMerge ? 2 : 1);
  if (out.kind == CorrectionKind::kSplit) {
    out.into_mm = places_from(node.at("into"), mm, 2);
    if (out.at_mm.size() > 1) {
      node.at("at").complain("names more wedges than one");
    }
  }
  return out;
}

}  // namespace

std::filesystem::path corrections_file_of(const std::filesystem::path& wedges_json) {
  std::filesystem::path out = wedges_json;
  return out.replace_extension(".corrections.json");
}

std::string corrections_to_json(const CorrectionFile& file) {
  OrderedJson root;
  root["unit"] = "mm";
  root["mesh"] = file.mesh;
  root["corrections"] = OrderedJson::array();
  for (const WedgeCorrection& correction : file.corrections) {
    OrderedJson json;
    json["do"] = kKinds[static_cast<std::size_t>(correction.kind)];
    if (correction.kind == CorrectionKind::kAdd) {
      json["reach"] = correction.reach_mm;
      json["region"] = places_json(correction.region_mm);
    } else {
      json["at"] = places_json(correction.at_mm);
    }
    if (correction.kind == CorrectionKind::kSplit) {
      json["into"] = places_json(correction.into_mm);
    }
    root["corrections"].push_back(std::move(json));
  }
  return root.dump(-1, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

std::string corrections_digest(const std::vector<WedgeCorrection>& corrections) {
  return xxh128_hex(corrections_to_json({{}, corrections}));
}

Status write_corrections(const std::filesystem::path& path, const CorrectionFile& file) {
  return write_file_atomically(path, with_own_checksum(corrections_to_json(file)));
}

Status replace_corrections(const std::filesystem::path& path, const std::vector<WedgeCorrection>& known,
                           const CorrectionFile& file) {
  const Result<WritersTurn> turn = WritersTurn::take(folder_of(path));
  if (!turn) {
    return std::unexpected(turn.error());
  }
  const Result<CorrectionFile> there = read_corrections(path);
  if (!there) {
    return std::unexpected(there.error());
  }
  if (corrections_to_json({{}, there->corrections}) != corrections_to_json({{}, known})) {
    return fail(ErrorKind::kUsage, "another program has changed the corrections meanwhile", path.string(),
                "read the wedges again, then say it again");
  }
  return write_corrections(path, file);
}

Result<CorrectionFile> parse_corrections(std::string_view text, const std::string& where) {
  const Result<JsonDocument> document = parse_self_checked(text, where);
  if (!document) {
    return std::unexpected(document.error());
  }
  const JsonNode root = document->root();
  root.only({"unit", "mesh", "corrections", kOwnChecksum});
  const double mm = mm_per_unit_of(root);
  CorrectionFile file;
  if (const auto mesh = root.find("mesh")) {
    file.mesh = mesh->text();
  }
  for (const JsonNode& node : root.at("corrections").items()) {
    file.corrections.push_back(correction_from(node, mm));
  }
  if (Status status = document->status("see docs/formats/corrections.md"); !status) {
    return std::unexpected(status.error());
  }
  return file;
}

Result<CorrectionFile> read_corrections(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return CorrectionFile();
  }
  const Result<std::string> text = read_whole_file(path, kMaxJsonBytes);
  return text ? parse_corrections(*text, path.string()) : std::unexpected(text.error());
}

}  // namespace dubsar
