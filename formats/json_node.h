// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "core/rigid_transform.h"

namespace dubsar {

inline constexpr std::size_t kMaxJsonBytes = std::size_t{64} << 20U;
inline constexpr int kMaxJsonDepth = 64;

/// Deepest nesting of brackets outside of strings. A parsed value is copied, compared and printed by calls
/// within calls, level by level: ask before, where the text comes from outside.
[[nodiscard]] int json_depth(std::string_view text);

/// A value inside an outside JSON document, with its path ("scans[3].tips[0].position"). Reads of a missing
/// or wrong-typed value give a neutral one and note the first complaint in the document; check
/// JsonDocument::status() at the end instead of after every value.
class JsonNode {
 public:
  /// The member of that name; noted as missing when it is not there.
  [[nodiscard]] JsonNode at(const char* key) const;
  /// The member of that name unless it is absent or null.
  [[nodiscard]] std::optional<JsonNode> find(const char* key) const;

  /// Complains about a member of any other name: for files where a misspelt word must not pass unseen.
  void only(const std::vector<std::string>& names) const;

  /// Elements of an array; anything else is noted and gives none.
  [[nodiscard]] std::vector<JsonNode> items() const;
  /// The entry of an array; noted when there are not as many.
  [[nodiscard]] JsonNode item(std::size_t index) const;
  /// Entries of an array, 0 for anything else.
  [[nodiscard]] std::size_t size() const;
  /// Whether anything in the document was complained about.
  [[nodiscard]] bool failed() const { return complaint_->has_value(); }
  [[nodiscard]] double number(double low = -std::numeric_limits<double>::max(),
                              double high = std::numeric_limits<double>::max()) const;
  [[nodiscard]] std::int64_t integer(std::int64_t low, std::int64_t high) const;
  /// Any number of 64 bits without a sign: seeds.
  [[nodiscard]] std::uint64_t unsigned_integer() const;
  [[nodiscard]] std::string text() const;
  /// For what another program may have said in a way of its own: nothing is noted.
  [[nodiscard]] bool is_text() const;
  [[nodiscard]] bool is_null() const;  ///< nothing is known here, and that is said
  [[nodiscard]] bool is_whole_number(std::int64_t low, std::int64_t high) const;
  [[nodiscard]] bool boolean() const;
  /// The position in `words` of the text that stands here.
  [[nodiscard]] std::size_t one_of(const std::vector<std::string>& words) const;
  /// Exactly `count` finite numbers.
  [[nodiscard]] std::vector<double> numbers(std::size_t count) const;
  [[nodiscard]] Eigen::Vector3d vector3() const;
  /// 16 row-major numbers that are a rigid transform; a rotation that was rounded in print is put back onto
  /// SO(3), one that is exact stays as it is. Lengths are multiplied by mm_per_unit.
  [[nodiscard]] RigidTransform transform(double mm_per_unit = 1.0) const;

  /// Notes a complaint about this value, unless there was one before.
  void complain(const std::string& what) const;

 private:
  friend class JsonDocument;
  JsonNode(const nlohmann::json* value, std::string path, std::optional<std::string>* complaint)
      : value_(value), path_(std::move(path)), complaint_(complaint) {}

  const nlohmann::json* value_;  ///< null after a complaint
  std::string path_;
  std::optional<std::string>* complaint_;
};

/// A parsed document that keeps the first complaint of its nodes. Depth and size are bounded.
class JsonDocument {
 public:
  [[nodiscard]] static Result<JsonDocument> parse(std::string_view text, const std::string& where);
  /// The document itself, which must be an object.
  [[nodiscard]] JsonNode root() const;
  [[nodiscard]] Status status(const std::string& mend) const;

 private:
  JsonDocument() = default;
  struct State {
    State() noexcept(false) {}     // the value's own constructor may throw, though it does not say so
    State(const State&) = delete;  // nodes point into it
    State& operator=(const State&) = delete;
    nlohmann::json value;
    std::string where;
    std::optional<std::string> complaint;
  };
  std::unique_ptr<State> state_;
};

/// What the numbers of the document are ("unit", millimetres when it says nothing).
[[nodiscard]] double mm_per_unit_of(const JsonNode& root);

}  // namespace dubsar
