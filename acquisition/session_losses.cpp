// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/session_losses.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>

#include "acquisition/session_files.h"
#include "acquisition/session_query.h"
#include "acquisition/session_tables.h"
#include "core/shell_word.h"

namespace dubsar::session {

namespace fs = std::filesystem;

namespace {

constexpr const char* kBetween = " row ";
/// A number with a checksum that fits may still be anybody's: as many missing ones are named, and no more.
constexpr std::int64_t kMostMissing = 10000;
constexpr std::int64_t kLastNumber = std::int64_t{1} << 53U;

std::string text_of(const nlohmann::json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// Of a record of losses, or of what came back. What is not as Dubsar writes it says nothing.
void read_rows(const nlohmann::json& json, const auto& visit) {
  if (!json.is_object() || !json.contains("rows") || !json["rows"].is_array()) {
    return;
  }
  for (const nlohmann::json& row : json["rows"]) {
    if (row.is_string()) {
      visit(row.get<std::string>());
    }
  }
}

bool says(const nlohmann::json& json, const char* key) {
  return json.is_object() && json.contains(key) && json[key].is_boolean() && json[key].get<bool>();
}

/// The number of a row, as it is written in the name of that row.
std::optional<std::int64_t> number_of(std::string_view key) {
  std::int64_t number = 0;
  const auto [rest, problem] = std::from_chars(key.data(), key.data() + key.size(), number);
  const bool is_it = problem == std::errc{} && std::to_string(number) == key;
  return is_it ? std::optional(number) : std::nullopt;
}

bool is_taken_out(SqlDatabase& db, std::string_view id) {
  const std::optional<std::int64_t> number = number_of(id);
  Result<SqlStatement> query = db.prepare("SELECT 1 FROM scans WHERE dropped <> 0 AND id = ?1");
  return number && query && query->bind(1, *number).step().value_or(false);
}

/// Whether the row came again by itself, as it was made anew, or is one that nothing needs: a result of a
/// scan that was taken out.
bool was_made_anew(SqlDatabase& db, const std::string& row, bool events_whole) {
  if (row.starts_with("events ")) {
    return false;  // another event may have its number
  }
  if (row.starts_with("poses ") || row.starts_with("flags ")) {
    const std::size_t key = row.find(kBetween) + std::string_view(kBetween).size();
    return has_row(db, row) || is_taken_out(db, std::string_view(row).substr(key));
  }
  return has_row(db, row) && (events_whole || !row.starts_with("scans "));
}

}  // namespace

std::string row_name(std::string_view table, std::string_view key) {
  return std::string(table) + kBetween + std::string(key);
}

bool has_row(SqlDatabase& db, const std::string& row) {
  const std::size_t at = row.find(kBetween);
  for (const Table& table : kTables) {
    if (at == std::string::npos || row.substr(0, at) != table.name) {
      continue;
    }
    // By its index: a session has tens of thousands of events, and each may be asked for.
    const std::string column = key_of(table);
    const std::string sql = std::string("SELECT 1 FROM ") + table.name + " WHERE " + column +
                            " = ?1 AND sum IS dubsar_sum(" + table.columns + ")";
    Result<SqlStatement> query = db.prepare(sql.c_str());
    if (!query) {
      return false;
    }
    const std::string_view key = std::string_view(row).substr(at + std::string_view(kBetween).size());
    if (column == "name" || column == "path") {
      return query->bind(1, key).step().value_or(false);
    }
    const std::optional<std::int64_t> number = number_of(key);
    return number && query->bind(1, *number).step().value_or(false);
  }
  return false;
}

Status note_losses(SqlDatabase& db, const Losses& lost) {
  return insert_event(db, kRecordsLost, text_of({{"rows", lost.rows}, {"more", lost.more}}));
}

Status note_brought_back(SqlDatabase& db, const std::vector<std::string>& rows, bool all) {
  return insert_event(db, kBroughtBack, text_of({{"rows", rows}, {"all", all}}));
}

Result<Losses> standing_losses(SqlDatabase& db) {
  Losses out;
  Losses missing;  // numbers of events
  std::int64_t expected = 1;
  const Status read = for_each_row(db,
                                   "SELECT number, kind, json FROM events WHERE sum IS "
                                   "dubsar_sum(number,time_ns,kind,json) ORDER BY number",
                                   [&](const SqlStatement& row) -> Status {
                                     const std::int64_t number = row.integer(0);
                                     if (number < expected || number > kLastNumber) {
                                       return {};
                                     }
                                     missing.more = missing.more || number - expected > kMostMissing;
                                     for (; expected < number && !missing.more; ++expected) {
                                       missing.rows.insert(row_name("events", std::to_string(expected)));
                                     }
                                     expected = number + 1;
                                     const std::string kind = row.text(1);
                                     if (kind != kRecordsLost && kind != kBroughtBack) {
                                       return {};
                                     }
                                     const nlohmann::json json =
                                         nlohmann::json::parse(row.text(2), nullptr, false);
                                     if (kind == kRecordsLost) {
                                       read_rows(json, [&](const std::string& one) { out.rows.insert(one); });
                                       out.more = out.more || says(json, "more");
                                     } else if (says(json, "all")) {
                                       out = {};
                                     } else {
                                       read_rows(json, [&](const std::string& one) { out.rows.erase(one); });
                                     }
                                     return {};
                                   });
  if (!read) {
    return std::unexpected(read.error());
  }
  const auto is_event = [](const std::string& row) { return row.starts_with("events "); };
  const bool events_whole = !out.more && !missing.any() && std::ranges::none_of(out.rows, is_event);
  std::erase_if(out.rows, [&](const std::string& row) { return was_made_anew(db, row, events_whole); });
  out.rows.merge(missing.rows);
  out.more = out.more || missing.more;
  return out;
}

std::vector<Error> told_losses(const Losses& lost, const std::string& where, const fs::path& folder) {
  const std::string mend =
      "bring it back from a copy (dubsar verify --repair --from COPY " + word_of(folder) + ")";
  std::vector<Error> out;
  if (lost.more && lost.unlisted > 0) {
    out.push_back(missing_log_error(lost.unlisted, folder));
  } else if (lost.more) {
    out.push_back({ErrorKind::kBadInput,
                   "records are lost that nothing names: a part of the tables could not be read, or their "
                   "log was missing",
                   where, mend});
  }
  for (const std::string& row : lost.rows) {
    out.push_back({ErrorKind::kBadInput, row + " is lost", where, mend});
  }
  return out;
}

Error missing_log_error(std::int64_t unlisted, const fs::path& folder) {
  return {ErrorKind::kBadInput,
          "records are lost that nothing names: the log is missing, or its end, for " +
              std::to_string(unlisted) + " whole grids are in no table",
          std::string(kDatabase) + "-wal",
          "put it back before anything is written, or bring its records back from a copy (dubsar verify "
          "--repair --from COPY " +
              word_of(folder) + ")"};
}

std::string word_of(const fs::path& folder) {
  std::error_code ignored;
  const fs::path whole = fs::absolute(folder, ignored).lexically_normal();
  return shell_word((whole.has_filename() ? whole : whole.parent_path()).string());
}

}  // namespace dubsar::session
