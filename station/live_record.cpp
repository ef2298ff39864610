// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the operator says of the tablet: kept as its line is left, and tried again where that was refused.
#include "station/live_session.h"
#include "station/session_pages.h"

namespace dubsar {

void LiveSession::describe(const TabletRecord& record) {
  {
    const std::scoped_lock lock(mutex_);
    if (!(state_.record == record)) {
      state_.package.clear();  // it says otherwise
    }
    state_.record = record;
    if (engine_ && engine_->post(DescribeTablet{record})) {
      record_told_ = record;
      return;
    }
    if (busy_) {  // no engine is wanted for it: that would open the device
      record_later_ = record;
      state_.record_kept = false;  // not yet
      return;
    }
  }
  launch([this, record] { keep_record(record); }, Job::kMendsNothing);
}

void LiveSession::keep_record(const TabletRecord& record) {
  Result<SessionStore> store =
      SessionStore::open_or_create(options_.session, SessionStore::OnDamage::kRefuse);
  const Status kept = store ? keep_tablet_record(*store, record) : std::unexpected(store.error());
  JobContext job;
  end(kept ? pages_follow_record(*store, job) : kept);
  const std::scoped_lock lock(mutex_);
  state_.record_kept = kept.has_value();
}

bool LiveSession::keeps_refused_record() {
  const LiveState now = state();
  if (!now.record_kept) {
    keep_record(now.record);
  }
  return now.record_kept || state().record_kept;
}

}  // namespace dubsar
