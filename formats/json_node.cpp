// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/json_node.h"

#include <algorithm>
#include <cmath>

#include "core/rigid_matrix.h"
#include "core/units.h"
#include "formats/text_scanner.h"

namespace dubsar {

namespace {

const char* is_what(const nlohmann::json& value) {
  switch (value.type()) {
    case nlohmann::json::value_t::object:
      return "is an object";
    case nlohmann::json::value_t::array:
      return "is an array";
    case nlohmann::json::value_t::string:
      return "is text";
    case nlohmann::json::value_t::boolean:
      return "is true or false";
    case nlohmann::json::value_t::null:
      return "is null";
    default:
      return "is a number";
  }
}

}  // namespace

int json_depth(std::string_view text) {
  int depth = 0;
  int deepest = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') {
        ++i;
      } else if (c == '"') {
        in_string = false;
      }
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return deepest;
}

JsonNode JsonNode::at(const char* key) const {
  const std::string path = path_.empty() ? std::string(key) : path_ + "." + key;
  if (value_ == nullptr) {
    return {nullptr, path, complaint_};
  }
  if (!value_->is_object()) {
    complain(std::string(is_what(*value_)) + ", not an object");
    return {nullptr, path, complaint_};
  }
  const auto member = value_->find(key);
  JsonNode node(member == value_->end() ? nullptr : &*member, path, complaint_);
  if (node.value_ == nullptr) {
    node.complain("is missing");
  }
  return node;
}

std::optional<JsonNode> JsonNode::find(const char* key) const {
  if (value_ == nullptr || !value_->is_object()) {
    return std::nullopt;
  }
  const auto member = value_->find(key);
  if (member == value_->end() || member->is_null()) {
    return std::nullopt;
  }
  return at(key);
}

void JsonNode::only(const std::vector<std::string>& names) const {
  if (value_ == nullptr || !value_->is_object()) {
    return;
  }
  for (const auto& [name, value] : value_->items()) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      std::string known;
      for (const std::string& one : names) {
        known += (known.empty() ? "" : ", ") + one;
      }
      complain("has " + in_quotes(name) + ", and knows " + known);
    }
  }
}

std::vector<JsonNode> JsonNode::items() const {
  std::vector<JsonNode> nodes;
  if (value_ == nullptr) {
    return nodes;
  }
  if (!value_->is_array()) {
    complain(std::string(is_what(*value_)) + ", not an array");
    return nodes;
  }
  nodes.reserve(value_->size());
  for (std::size_t i = 0; i < value_->size(); ++i) {
    std::string path = path_;
    path += '[';
    path += std::to_string(i);
    path += ']';
    nodes.push_back(JsonNode(&(*value_)[i], std::move(path), complaint_));
  }
  return nodes;
}

JsonNode JsonNode::item(std::size_t index) const {
  std::string path = path_;
  path += '[';
  path += std::to_string(index);
  path += ']';
  const bool there = value_ != nullptr && value_->is_array() && index < value_->size();
  JsonNode node(there ? &(*value_)[index] : nullptr, std::move(path), complaint_);
  if (value_ != nullptr && !there) {
    node.complain("is missing");
  }
  return node;
}

std::size_t JsonNode::size() const {
  return value_ != nullptr && value_->is_array() ? value_->size() : 0;
}

double JsonNode::number(double low, double high) const {
  const double neutral = std::clamp(0.0, low, high);
  if (value_ == nullptr) {
    return neutral;
  }
  if (!value_->is_number()) {
    complain(std::string(is_what(*value_)) + ", not a number");
    return neutral;
  }
  const auto number = value_->get<double>();
  if (!(number >= low && number <= high)) {
    complain("is " + value_->dump() + ", out of range");
    return neutral;
  }
  return number;
}

std::int64_t JsonNode::integer(std::int64_t low, std::int64_t high) const {
  const double real = number(static_cast<double>(low), static_cast<double>(high));
  if (real != std::floor(real)) {
    complain("is " + value_->dump() + ", not a whole number");
    return low;
  }
  if (value_ != nullptr && value_->is_number_integer()) {
    return std::clamp(value_->get<std::int64_t>(), low, high);
  }
  return static_cast<std::int64_t>(real);
}

std::uint64_t JsonNode::unsigned_integer() const {
  if (value_ == nullptr) {
    return 0;
  }
  if (!value_->is_number_unsigned()) {
    complain("is not a whole number from 0 to 18446744073709551615");
    return 0;
  }
  return value_->get<std::uint64_t>();
}

std::string JsonNode::text() const {
  if (value_ == nullptr) {
    return {};
  }
  if (!value_->is_string()) {
    complain(std::string(is_what(*value_)) + ", not text");
    return {};
  }
  return value_->get<std::string>();
}

bool JsonNode::is_null() const {
  return value_ != nullptr && value_->is_null();
}

bool JsonNode::is_text() const {
  return value_ != nullptr && value_->is_string();
}

bool JsonNode::is_whole_number(std::int64_t low, std::int64_t high) const {
  return value_ != nullptr && value_->is_number_integer() && *value_ >= low && *value_ <= high;
}

bool JsonNode::boolean() const {
  if (value_ == nullptr) {
    return false;
  }
  if (!value_->is_boolean()) {
    complain(std::string(is_what(*value_)) + ", not true or false");
    return false;
  }
  return value_->get<bool>();
}

std::size_t JsonNode::one_of(const std::vector<std::string>& words) const {
  const std::string word = text();
  const auto found = std::find(words.begin(), words.end(), word);
  if (found != words.end()) {
    return static_cast<std::size_t>(found - words.begin());
  }
  std::string known;
  for (const std::string& candidate : words) {
    known += (known.empty() ? "" : ", ") + candidate;
  }
  complain("is " + in_quotes(word) + ", none of " + known);
  return 0;
}

std::vector<double> JsonNode::numbers(std::size_t count) const {
  std::vector<double> values(count, 0.0);
  if (value_ == nullptr) {
    return values;
  }
  if (!value_->is_array() || value_->size() != count) {
    complain((value_->is_array() ? "has " + std::to_string(value_->size()) + " entries"
                                 : std::string(is_what(*value_))) +
             ", not " + std::to_string(count) + " numbers");
    return values;
  }
  const std::vector<JsonNode> nodes = items();
  for (std::size_t i = 0; i < count; ++i) {
    values[i] = nodes[i].number();
  }
  return values;
}

Eigen::Vector3d JsonNode::vector3() const {
  const std::vector<double> v = numbers(3);
  return {v[0], v[1], v[2]};
}

RigidTransform JsonNode::transform(double mm_per_unit) const {
  const std::vector<double> values = numbers(16);
  if (value_ == nullptr || complaint_->has_value()) {
    return {};
  }
  const std::optional<RigidTransform> rigid = rigid_from_row_major(std::span(values).first<16>());
  if (!rigid) {
    complain("is not a rigid transform (rotation, translation, last row 0 0 0 1; row major)");
    return {};
  }
  constexpr double kExact = 1e-9;
  RigidTransform t = rigid->is_rigid(kExact) ? *rigid : rigid->orthonormalised();
  t.translation_mm *= mm_per_unit;
  return t;
}

void JsonNode::complain(const std::string& what) const {
  if (!*complaint_) {
    *complaint_ = (path_.empty() ? std::string("the document") : path_) + " " + what;
  }
}

Result<JsonDocument> JsonDocument::parse(std::string_view text, const std::string& where) {
  if (text.size() > kMaxJsonBytes) {
    return bad_input(where, "more than " + std::to_string(kMaxJsonBytes) + " bytes of JSON",
                     "check what the file is");
  }
  if (text.empty()) {
    return bad_input(where, "the file is empty", "copy or write it again");
  }
  if (json_depth(text) > kMaxJsonDepth) {
    return bad_input(where, "nested deeper than " + std::to_string(kMaxJsonDepth) + " levels",
                     "check what the file is");
  }
  JsonDocument document;
  document.state_ = std::make_unique<State>();
  document.state_->where = where;
  try {
    document.state_->value = nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    const std::size_t at = std::min(error.byte, text.size());
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    return bad_input(where,
                     "line " + std::to_string(line) + ": not JSON from byte " + std::to_string(at) + " on",
                     "mend or write the file again");
  } catch (const nlohmann::json::exception&) {
    return bad_input(where, "a number in it is too large", "mend or write the file again");
  }
  if (!document.state_->value.is_object()) {
    return bad_input(where,
                     std::string("the document ") + is_what(document.state_->value) + ", not an object",
                     "check what the file is");
  }
  return document;
}

JsonNode JsonDocument::root() const {
  return {&state_->value, "", &state_->complaint};
}

Status JsonDocument::status(const std::string& mend) const {
  if (state_->complaint) {
    return bad_input(state_->where, *state_->complaint, mend);
  }
  return {};
}

double mm_per_unit_of(const JsonNode& root) {
  const std::optional<JsonNode> unit = root.find("unit");
  if (!unit) {
    return 1.0;
  }
  const std::optional<double> mm = mm_per_unit(unit->text());
  if (!mm) {
    unit->complain("is not " + std::string(kLengthUnitsText));
  }
  return mm.value_or(1.0);
}

}  // namespace dubsar
