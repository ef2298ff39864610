// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a session has lost of its records, from a copy of it.
#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "acquisition/session_impl.h"
#include "acquisition/session_presence.h"
#include "acquisition/session_query.h"
#include "acquisition/session_rebuild.h"
#include "formats/grid_file.h"
#include "formats/sign_off_json.h"

namespace dubsar::session {

namespace fs = std::filesystem;

namespace {

struct Event {
  std::int64_t time_ns = 0;
  std::string kind;
  std::string json;
  bool operator==(const Event&) const = default;
};
using Events = std::map<std::int64_t, Event>;

Result<Events> events_of(SqlDatabase& db) {
  Events out;
  const Status read = for_each_row(
      db, "SELECT number,time_ns,kind,json FROM events WHERE sum IS dubsar_sum(number,time_ns,kind,json)",
      [&](const SqlStatement& row) -> Status {
        out.emplace(row.integer(0), Event{row.integer(1), row.text(2), row.text(3)});
        return {};
      });
  return read ? Result<Events>(std::move(out)) : std::unexpected(read.error());
}

/// How the record of the session and that of the copy hang together.
struct Lineage {
  std::int64_t last_same = 0;  ///< event that both have; 0: none
  std::int64_t parted = 0;     ///< first number under which they have different ones; 0: none
  bool since_loss = false;     ///< from there on the session's came after the loss: they follow the copy's
  std::int64_t last_before_loss = 0;  ///< of the session's events
};

bool is_after_a_loss(std::int64_t number, const Event& event) {
  // A version that noted no losses began the record again with the grids that it took in.
  return event.kind == kRecordsLost || (number == 1 && event.kind == kAdopted);
}

Lineage lineage_of(const Events& own, const Events& copy, const Losses& lost) {
  Lineage out;
  bool before = true;
  for (const auto& [number, event] : own) {
    before = before && !is_after_a_loss(number, event);
    out.last_before_loss = before ? number : out.last_before_loss;
    const auto other = copy.find(number);
    if (other == copy.end()) {
      continue;
    }
    if (event == other->second) {
      out.last_same = number;
    } else if (out.parted == 0) {
      out.parted = number;
      out.since_loss = is_after_a_loss(number, event) &&
                       (lost.more || lost.rows.contains(row_name("events", std::to_string(number))) ||
                        event.kind == kAdopted);
    }
  }
  return out;
}

/// Of a signature that can be read; 0: it is none.
int sign_off_number(const Event& event) {
  const Result<RecordedSignOff> recorded =
      event.kind == "signed" ? parse_recorded_sign_off(event.json, {}) : std::unexpected(Error{});
  return recorded ? recorded->sign_off.number : 0;
}

/// Where no event tells: every whole grid that both have under one number is the same, and there is one.
bool has_same_grids(const fs::path& folder, SqlDatabase& copy) {
  int same = 0;
  bool other = false;
  const Status read =
      for_each_row(copy, "SELECT id, bytes, hash FROM scans", [&](const SqlStatement& row) -> Status {
        const fs::path file = folder / grid_name(static_cast<int>(row.integer(0)));
        const Result<FileSum> sum = sum_of_file(file);
        if (sum && *sum == FileSum{row.integer(1), row.integer(2)}) {
          ++same;
        } else if (sum && verify_grid_file(file)) {
          other = true;
        }
        return {};
      });
  return read && same > 0 && !other;
}

/// The work of one bringing back; everything in one transaction of the session's database.
class BringingBack {
 public:
  BringingBack(const fs::path& folder, SqlDatabase& own, SqlDatabase& copy, Losses lost)
      : folder_(folder), own_(own), copy_(copy), lost_(std::move(lost)) {}

  /// Why the copy gives nothing.
  [[nodiscard]] Result<std::optional<std::string>> compare();
  [[nodiscard]] Status take();
  [[nodiscard]] const std::vector<std::string>& rows() const { return rows_; }
  /// Of the copy.
  [[nodiscard]] std::int64_t last_event() const {
    return copy_events_.empty() ? 0 : copy_events_.rbegin()->first;
  }

 private:
  [[nodiscard]] bool is_lost(const char* table, const std::string& key) const {
    return lost_.more || lost_.rows.contains(row_name(table, key));
  }
  [[nodiscard]] std::vector<std::int64_t> lost_events() const;
  [[nodiscard]] bool is_late() const {
    return !copy_events_.empty() && last_event() >= lineage_.last_before_loss;
  }
  [[nodiscard]] bool is_all() const;
  [[nodiscard]] Status take_events();
  [[nodiscard]] Status take_scans();
  [[nodiscard]] bool may_take_file(const std::string& path) const;
  [[nodiscard]] bool may_take_scan(const std::string& file) const;
  void take_table(const char* name, const std::function<bool(const std::string&)>& also = {});
  [[nodiscard]] Status renumber(std::int64_t from, std::int64_t by);

  const fs::path& folder_;
  SqlDatabase& own_;
  SqlDatabase& copy_;
  Losses lost_;
  Events own_events_;
  Events copy_events_;
  Lineage lineage_;
  std::vector<std::string> rows_;
};

/// Numbers of the copy's events that the session lacks.
std::vector<std::int64_t> BringingBack::lost_events() const {
  std::vector<std::int64_t> out;
  for (const auto& [number, event] : copy_events_) {
    const auto own = own_events_.find(number);
    const bool same = own != own_events_.end() && own->second == event;
    // What came after they had parted may be of the copy alone.
    const bool together = lineage_.parted == 0 || lineage_.since_loss || number < lineage_.last_same;
    if (!same && together && is_lost("events", std::to_string(number)) &&
        (own == own_events_.end() || lineage_.since_loss)) {
      out.push_back(number);
    }
  }
  return out;
}

Result<std::optional<std::string>> BringingBack::compare() {
  Result<Events> own = events_of(own_);
  Result<Events> copy = events_of(copy_);
  if (!own || !copy) {
    return std::unexpected(own ? copy.error() : own.error());
  }
  own_events_ = std::move(*own);
  copy_events_ = std::move(*copy);
  lineage_ = lineage_of(own_events_, copy_events_, lost_);
  if (lineage_.last_same == 0 && (lineage_.last_before_loss > 0 || !has_same_grids(folder_, copy_))) {
    return "nothing shows that it is a copy of this session";
  }
  const auto was_signed = [](const Events& events, std::int64_t from) {
    return std::any_of(events.lower_bound(from), events.end(),
                       [](const auto& one) { return one.second.kind == "signed"; });
  };
  if (lineage_.since_loss && was_signed(own_events_, lineage_.parted) &&
      was_signed(copy_events_, lineage_.parted)) {
    return "both were signed since the loss, and no signature may take the place of another";
  }
  for (const std::int64_t lost : lost_events()) {
    const int number = sign_off_number(copy_events_.at(lost));
    const auto has_it = [&](const auto& one) { return sign_off_number(one.second) == number; };
    if (number > 0 && std::ranges::any_of(own_events_, has_it)) {
      return "sign-off " + std::to_string(number) +
             " was lost and another has its number since, and no signature may take the place of another";
    }
  }
  return std::nullopt;
}

/// A lock names the number of another in whose frame it stands.
std::string with_frame_moved(const std::string& json, std::int64_t from, std::int64_t by) {
  nlohmann::ordered_json detail = nlohmann::ordered_json::parse(json, nullptr, false);
  if (!detail.is_object() || !detail.contains("frame") || !detail["frame"].is_number_integer() ||
      detail["frame"].get<std::int64_t>() < from) {
    return json;
  }
  detail["frame"] = detail["frame"].get<std::int64_t>() + by;
  return detail.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Status BringingBack::renumber(std::int64_t from, std::int64_t by) {
  for (auto at = own_events_.rbegin(); at != own_events_.rend() && at->first >= from; ++at) {
    Result<SqlStatement> take = own_.prepare("DELETE FROM events WHERE number = ?1");
    if (Status taken = take ? take->bind(1, at->first).run() : std::unexpected(take.error()); !taken) {
      return taken;
    }
    Result<SqlStatement> put = own_.prepare(insert_sql(table_named("events")).c_str());
    if (!put) {
      return std::unexpected(put.error());
    }
    const Event& event = at->second;
    put->bind(1, at->first + by).bind(2, event.time_ns).bind(3, event.kind);
    put->bind(4, with_frame_moved(event.json, from, by));
    if (Status done = put->run(); !done) {
      return done;
    }
  }
  return {};
}

Status BringingBack::take_events() {
  const std::vector<std::int64_t> wanted = lost_events();
  if (lineage_.since_loss && !wanted.empty() && wanted.back() >= lineage_.parted) {
    if (Status moved = renumber(lineage_.parted, wanted.back() - lineage_.parted + 1); !moved) {
      return moved;
    }
  }
  for (const std::string& key : salvage_some(table_named("events"), copy_, own_, [&](const std::string& key) {
         return std::ranges::binary_search(wanted, std::atoll(key.c_str()));
       })) {
    rows_.push_back(row_name("events", key));
  }
  return {};
}

void BringingBack::take_table(const char* name, const std::function<bool(const std::string&)>& also) {
  const auto wanted = [&](const std::string& key) { return is_lost(name, key) && (!also || also(key)); };
  for (const std::string& key : salvage_some(table_named(name), copy_, own_, wanted)) {
    rows_.push_back(row_name(name, key));
  }
}

/// A grid that is missing or damaged keeps its row from nothing: the row says what it was.
bool BringingBack::may_take_scan(const std::string& file) const {
  const auto sum = recorded_sum(copy_, file);
  return may_take_file(file) || (sum && *sum && !verify_grid_file(folder_ / file));
}

bool BringingBack::may_take_file(const std::string& path) const {
  std::error_code unknown;
  const auto sum = recorded_sum(copy_, path);
  if (!in_a_folder_of_the_session(path) || !sum || !*sum) {
    return false;
  }
  // One that was made anew since is not what the copy's sum is of.
  const Result<FileSum> here = sum_of_file(folder_ / path);
  return here ? *here == **sum : !fs::exists(folder_ / path, unknown);
}

Status BringingBack::take_scans() {
  // Rows that were made of the grids alone, after the loss: they do not know what was taken out. What the
  // copy has of them is of the same bytes, whatever lies there by now.
  std::set<int> replaced;
  for (const auto& [number, event] : own_events_) {
    const nlohmann::json detail = nlohmann::json::parse(event.json, nullptr, false);
    if (event.kind != kAdopted || !detail.is_object() || !detail.contains("id") ||
        !detail["id"].is_number_integer()) {
      continue;
    }
    const int id = detail["id"].get<int>();
    const auto own = recorded_sum(own_, grid_name(id));
    const auto there = recorded_sum(copy_, grid_name(id));
    if (!is_lost("scans", std::to_string(id)) || !own || !there || !*own || *own != *there ||
        !has_row(copy_, row_name("scans", std::to_string(id)))) {
      continue;
    }
    replaced.insert(id);
    Result<SqlStatement> take = own_.prepare("DELETE FROM scans WHERE id = ?1");
    if (Status taken = take ? take->bind(1, id).run() : std::unexpected(take.error()); !taken) {
      return taken;
    }
  }
  const std::size_t before = rows_.size();
  take_table("scans", [&](const std::string& key) {
    int id = -1;
    const auto [rest, problem] = std::from_chars(key.data(), key.data() + key.size(), id);
    return problem == std::errc{} && rest == key.data() + key.size() && id >= 0 &&
           (replaced.contains(id) || may_take_scan(grid_name(id)));
  });
  const Result<std::map<int, DropState>> drops = dropped_by_record(own_);
  if (!drops) {
    return std::unexpected(drops.error());
  }
  for (const auto& [id, state] : *drops) {
    const std::string row = row_name("scans", std::to_string(id));
    if (std::find(rows_.begin() + static_cast<std::ptrdiff_t>(before), rows_.end(), row) == rows_.end()) {
      continue;
    }
    if (Status marked = put_dropped(own_, id, state.dropped, state.why); !marked) {
      return marked;
    }
  }
  return {};
}

/// Nothing is known to lack any more: the copy goes as far as what was left of the record, lists every grid,
/// and had each row that was named.
bool BringingBack::is_all() const {
  const bool listed = std::ranges::all_of(
      grid_ids(folder_), [&](int id) { return has_row(own_, row_name("scans", std::to_string(id))); });
  const std::set<std::string> came(rows_.begin(), rows_.end());
  const bool each = std::ranges::all_of(lost_.rows, [&](const std::string& row) {
    return came.contains(row) || (!row.starts_with("events ") && has_row(own_, row));
  });
  return is_late() && listed && each;
}

Status BringingBack::take() {
  return in_transaction(own_, [&]() -> Status {
    if (Status taken = take_events(); !taken) {
      return taken;
    }
    if (Status taken = take_scans(); !taken) {
      return taken;
    }
    take_table("documents");
    take_table("files", [&](const std::string& path) { return may_take_file(path); });
    const auto results =
        own_.integer_of("SELECT (SELECT count(*) FROM poses) + (SELECT count(*) FROM flags)");
    if (results_fit(copy_, own_) && (is_late() || results.value_or(0) > 0)) {
      take_table("poses");
      take_table("flags");
    }
    const bool all = is_all();
    return rows_.empty() && !all ? Status() : note_brought_back(own_, rows_, all);
  });
}

/// "events row 12", or "9 rows of events".
std::vector<std::string> summed_up(const std::vector<std::string>& rows) {
  constexpr std::size_t kMostNamed = 8;
  std::vector<std::string> out;
  for (const Table& table : kTables) {
    std::vector<std::string> of_it;
    std::ranges::copy_if(rows, std::back_inserter(of_it),
                         [&](const std::string& row) { return row.starts_with(row_name(table.name, "")); });
    if (of_it.size() > kMostNamed) {
      of_it = {std::to_string(of_it.size()) + " rows of " + table.name};
    }
    out.insert(out.end(), of_it.begin(), of_it.end());
  }
  return out;
}

}  // namespace

Status bring_back_records(const fs::path& folder, const fs::path& copy, SqlDatabase& db,
                          SessionOpening& opening) {
  Result<Losses> lost = standing_losses(db);
  if (!lost || !lost->any()) {
    return lost ? Status() : std::unexpected(lost.error());
  }
  SessionOpening of_copy;
  bool rebuilt = false;
  Losses lost_there;
  Result<SqlDatabase> there = open_for_reading(copy, of_copy, rebuilt, lost_there);
  if (!there) {
    opening.no_use_of_copy = there.error();
    return {};
  }
  const bool more = lost->more;
  BringingBack work(folder, db, *there, std::move(*lost));
  const Result<std::optional<std::string>> unlike = work.compare();
  if (!unlike) {
    return std::unexpected(unlike.error());
  }
  if (*unlike) {
    opening.no_use_of_copy = Error{ErrorKind::kBadInput, **unlike + ": no record was taken from it",
                                   copy.string(), "name another copy"};
    return {};
  }
  if (Status taken = work.take(); !taken) {
    return taken;
  }
  opening.brought_back = summed_up(work.rows());
  if (work.rows().empty()) {
    opening.no_use_of_copy =
        Error{ErrorKind::kBadInput, "it has none of the lost records", copy.string(), "name another copy"};
  } else if (more) {
    opening.notes.push_back("the records are as the copy has them, up to its event " +
                            std::to_string(work.last_event()) +
                            "; what was recorded after that is not known");
  }
  return {};
}

}  // namespace dubsar::session
