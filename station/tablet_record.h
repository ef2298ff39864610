// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/session_store.h"
#include "core/result.h"

namespace dubsar {

/// What people say of the tablet that a session is of (document "tablet"). Every field may be empty.
struct TabletRecord {
  std::string museum_number;
  std::string cdli;  ///< "P" and six digits
  std::string collection;
  std::string operator_name;
  std::string rights;  ///< whose they are and under which licence they may be used, as a sentence
  std::string notes;
  bool operator==(const TabletRecord&) const = default;
};

/// kUsage, with the mend, for a CDLI number that is none; empty is no complaint.
[[nodiscard]] Status check_cdli(std::string_view number);

[[nodiscard]] std::string tablet_record_to_json(const TabletRecord& record);
[[nodiscard]] Result<TabletRecord> parse_tablet_record(std::string_view text, const std::string& where);

/// For people: name of the field and what it says, empty ones left out.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> words_of(const TabletRecord& record);

/// Checks it and keeps it in the session, without the blanks around what is said; what was said before stays
/// in the session's events ("tablet described"), for a number that is mended after the sign-off must not look
/// as if it had always stood there.
Status keep_tablet_record(SessionStore& store, const TabletRecord& said);
/// Empty when none is kept, or it cannot be read.
[[nodiscard]] TabletRecord tablet_record_of(const SessionStore& store);

}  // namespace dubsar
