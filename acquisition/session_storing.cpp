// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A scan comes into a session: its grid first, then its row. A row without its grid would be a scan that is
// lost; a grid without its row is taken in by whoever opens the session next. There is one of these at most,
// for two prove that the log which had their rows is missing (session_open.cpp).
#include <algorithm>
#include <nlohmann/json.hpp>

#include "acquisition/session_impl.h"
#include "acquisition/session_query.h"
#include "formats/atomic_file.h"
#include "formats/grid_file.h"

namespace dubsar {

namespace fs = std::filesystem;
using session::FileSum;

namespace {

Status check_arrays(const RangeGrid& grid) {
  const auto n =
      static_cast<std::size_t>(std::max(0, grid.rows)) * static_cast<std::size_t>(std::max(0, grid.cols));
  const auto fits = [n](std::size_t have, std::size_t per, bool optional) {
    return have == n * per || (optional && have == 0);
  };
  if (grid.rows < 0 || grid.cols < 0 || !fits(grid.x.size(), 1, false) || !fits(grid.y.size(), 1, false) ||
      !fits(grid.z.size(), 1, false) || !fits(grid.valid.size(), 1, false) ||
      !fits(grid.intensity.size(), 1, true) || !fits(grid.confidence.size(), 1, true) ||
      !fits(grid.rgb.size(), 3, true)) {
    return fail(ErrorKind::kInternal, "a grid whose arrays do not fit its rows and columns was to be stored",
                grid.source);
  }
  return {};
}

}  // namespace

Status SessionStore::Impl::list_grid(int id, const FileSum& sum, const RangeGrid& grid,
                                     const std::string& event, bool* in_the_balance) {
  return session::in_transaction(*db, [&]() -> Status {
    if (Status put = session::insert_scan(*db, id, sum, grid); !put) {
      return put;
    }
    Status noted = session::insert_event(*db, session::kScanStored, event);
    *in_the_balance = noted.has_value();
    return noted;
  });
}

Status SessionStore::Impl::list_refused() {
  if (!refused) {
    return {};
  }
  // In the log its row may stand, be overwritten or lack: one that is committed now stands for certain.
  const std::string name = session::grid_name(refused->id);
  if (std::error_code unknown; fs::exists(folder / name, unknown) || unknown) {
    const Result<std::string> bytes = read_whole_file(folder / name);
    const Result<RangeGrid> grid = bytes ? decode_grid(std::as_bytes(std::span(*bytes)), name)
                                         : Result<RangeGrid>(std::unexpected(bytes.error()));
    if (!grid) {
      return std::unexpected(grid.error());
    }
    const FileSum sum{static_cast<std::int64_t>(bytes->size()), session::hash_of(*bytes)};
    bool in_the_balance = false;
    if (Status listed = list_grid(refused->id, sum, *grid, refused->event, &in_the_balance); !listed) {
      return listed;
    }
  }
  refused.reset();
  return {};
}

Result<int> SessionStore::add_grid(const RangeGrid& grid, std::string_view remark) {
  if (Status writable = impl_->writable(); !writable) {
    return std::unexpected(writable.error());
  }
  if (Status fits = check_arrays(grid); !fits) {
    return std::unexpected(fits.error());
  }
  const std::vector<std::byte> bytes = encode_grid(grid);
  const std::string_view view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const FileSum sum{static_cast<std::int64_t>(bytes.size()), session::hash_of(view)};

  const std::scoped_lock hold(impl_->mutex);
  if (Status listed = impl_->list_refused(); !listed) {
    return std::unexpected(listed.error());
  }
  const Result<int> next = impl_->next_id();
  if (!next) {
    return next;
  }
  const int id = *next;
  const fs::path path = impl_->folder / session::grid_name(id);
  nlohmann::json detail{{"id", id}, {"source", grid.source}};
  if (!remark.empty()) {
    detail["remark"] = std::string(remark);
  }
  const std::string event = detail.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  bool in_the_balance = false;
  Status stored = write_file_atomically(path, std::span(bytes));
  if (stored) {
    stored = impl_->list_grid(id, sum, grid, event, &in_the_balance);
  }
  if (!stored) {
    // It was never reported as stored. But a commit whose sync failed may stand in the log all the same, and
    // its row would then lack its grid: that one stays, to be listed before another comes, or by whoever
    // opens the session next.
    std::error_code unknown;
    if (!in_the_balance) {
      fs::remove(path, unknown);
    }
    if (fs::exists(path, unknown) || unknown) {
      impl_->refused = Impl::Refused{id, event};
    }
    return std::unexpected(stored.error());
  }
  return id;
}

}  // namespace dubsar
