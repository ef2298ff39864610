// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/next_session.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <system_error>

#include "station/session_name.h"

namespace dubsar {

namespace fs = std::filesystem;

fs::path next_session_name(const fs::path& session) {
  const fs::path folder = whole_name(session);
  std::string stem = folder.filename().string();
  int number = 1;
  if (const auto dash = stem.rfind('-'); dash != std::string::npos && dash > 0) {
    int counted = 0;
    const char* end = stem.data() + stem.size();
    const auto [rest, error] = std::from_chars(stem.data() + dash + 1, end, counted);
    // Four digits and more are a museum's number ("BM-12345"): the next one is another tablet's.
    if (error == std::errc() && rest == end && counted > 0 && counted < 1000) {
      number = counted;
      stem.resize(dash);
    }
  }
  std::error_code ignored;
  fs::path name;
  do {
    ++number;
    name = stem + "-" + std::to_string(number);
  } while (fs::exists(folder.parent_path() / name, ignored));
  return name;
}

std::optional<FoundSession> session_found(const fs::path& folder) {
  if (!SessionStore::is_session(folder)) {
    return std::nullopt;
  }
  FoundSession out;
  const Result<SessionStore> store = SessionStore::open(folder, SessionStore::Access::kReadOnly);
  const auto scans = store ? store->scans() : std::unexpected(store.error());
  if (scans) {
    out.is_read = true;
    out.record = tablet_record_of(*store);
    out.scans = static_cast<int>(std::ranges::count(*scans, false, &StoredScan::dropped));
  }
  return out;
}

}  // namespace dubsar
