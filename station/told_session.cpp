// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/told_session.h"

#include "core/log.h"

namespace dubsar {

std::vector<std::string> told_of_opening(const SessionStore& store) {
  std::vector<std::string> out;
  for (const Error& damage : store.opening().damage) {
    out.push_back("damaged: " + damage.line());
  }
  const std::vector<std::string>& notes = store.opening().notes;
  out.insert(out.end(), notes.begin(), notes.end());
  return out;
}

Result<SessionStore> open_told(const std::filesystem::path& session, SessionStore::Access access,
                               SessionStore::OnDamage on_damage) {
  Result<SessionStore> store = SessionStore::open(session, access, on_damage);
  if (store) {
    for (const Error& damage : store->opening().damage) {
      log_warning(damage.line());
    }
    for (const std::string& note : store->opening().notes) {
      // What a kill left half done is put right every day; beside damage it tells what became of that.
      store->opening().damage.empty() ? log_info(note) : log_warning(note);
    }
  }
  return store;
}

Result<SessionStore> open_for_a_word(const std::filesystem::path& session) {
  return open_told(session, SessionStore::Access::kReadWrite, SessionStore::OnDamage::kRefuse);
}

}  // namespace dubsar
