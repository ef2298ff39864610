// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/verification_log.h"

#include "formats/atomic_file.h"
#include "formats/json_node.h"
#include "formats/json_text.h"
#include "formats/writers_turn.h"

namespace dubsar {

namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{64} << 20U;

std::optional<VerificationEntry> entry_of(std::string_view line) {
  // Only an object can be an entry. Of any other text there may be a great many lines, and the parser throws
  // at each. (\xEF: of the mark that some editors put at the beginning.)
  const std::size_t first = line.find_first_not_of(" \t\r");
  if (first == std::string_view::npos || (line[first] != '{' && line[first] != '\xEF')) {
    return std::nullopt;
  }
  const Result<JsonDocument> document = JsonDocument::parse(line, "log");
  if (!document) {
    return std::nullopt;
  }
  const JsonNode root = document->root();
  VerificationEntry entry;
  entry.when = root.at("when").text();
  entry.artefact = root.at("artefact").text();
  entry.certificate = root.at("certificate").text();
  entry.calibration = root.at("calibration").text();
  entry.error_mm = root.at("error_mm").number(0, 1e6);
  entry.passed = root.at("passed").boolean();
  for (const JsonNode& item : root.at("failed").items()) {
    entry.failed.push_back(item.text());
  }
  const auto measured = root.find("measured");
  entry.measured = measured ? measured->text() : std::string();
  return document->status({}) ? std::optional(std::move(entry)) : std::nullopt;
}

std::string line_of(const VerificationEntry& entry) {
  const OrderedJson json{{"when", entry.when},
                         {"artefact", entry.artefact},
                         {"certificate", entry.certificate},
                         {"calibration", entry.calibration},
                         {"error_mm", entry.error_mm},
                         {"passed", entry.passed},
                         {"failed", entry.failed},
                         {"measured", entry.measured}};
  return json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

}  // namespace

VerificationLog parse_verification_log(std::string_view text) {
  VerificationLog log;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(text.size(), end + 1));
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) {
      continue;
    }
    if (auto entry = entry_of(line)) {
      log.entries.push_back(std::move(*entry));
    } else {
      ++log.damaged;
    }
  }
  return log;
}

Result<VerificationLog> read_verification_log(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    return VerificationLog{};
  }
  const Result<std::string> text = read_whole_file(path, kMostBytes);
  if (!text) {
    return std::unexpected(text.error());
  }
  return parse_verification_log(*text);
}

Status append_verification(const std::filesystem::path& path, const VerificationEntry& entry) {
  const Result<WritersTurn> turn = WritersTurn::take(folder_of(path));
  if (!turn) {
    return std::unexpected(turn.error());
  }
  std::string whole;
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) {
    Result<std::string> text = read_whole_file(path, kMostBytes);
    if (!text) {
      return std::unexpected(text.error());
    }
    whole = std::move(*text);
    if (!whole.empty() && whole.back() != '\n') {
      whole += '\n';
    }
  }
  return write_file_atomically(path, whole + line_of(entry));
}

std::filesystem::path verification_log_of(const std::filesystem::path& calibration) {
  std::filesystem::path out = calibration;
  return out.replace_extension(".verified.jsonl");
}

}  // namespace dubsar
