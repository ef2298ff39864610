// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/unfinished_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/grid_rows.h"
#include "core/log.h"
#include "core/utf8.h"
#include "formats/atomic_file.h"
#include "formats/grid_file.h"
#include "station/drives.h"

namespace dubsar {

namespace fs = std::filesystem;

namespace {

constexpr const char* kDrive = "drive.json";
constexpr const char* kRemark = "remark.txt";
constexpr std::size_t kSmallFileBytes = 65536;

fs::path home_of(const fs::path& session) {
  return session / "grids" / "unfinished";
}

fs::path rows_file(const fs::path& folder, int number) {
  return folder / fmt::format("{:04}.grid", number);
}

/// Their numbers, ascending; whatever else lies there is not ours.
std::vector<int> numbered_folders(const fs::path& home) {
  std::vector<int> out;
  std::error_code ignored;
  for (fs::directory_iterator it(home, ignored), end; !ignored && it != end; it.increment(ignored)) {
    const std::string name = it->path().filename().string();
    if (!name.empty() && name.size() < 9 &&
        std::ranges::all_of(name, [](char c) { return c >= '0' && c <= '9'; })) {
      out.push_back(std::stoi(name));
    }
  }
  std::ranges::sort(out);
  return out;
}

fs::path next_folder(const fs::path& session) {
  const std::vector<int> there = numbered_folders(home_of(session));
  return home_of(session) / std::to_string(there.empty() ? 1 : there.back() + 1);
}

void take_away(const fs::path& folder) {
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  fs::remove(folder.parent_path(), ignored);  // only when it is empty
}

}  // namespace

UnfinishedScan::UnfinishedScan(const fs::path& session, std::optional<Placement> drive,
                               std::chrono::milliseconds every)
    : folder_(next_folder(session)), drive_(std::move(drive)), every_(every) {}

UnfinishedScan::~UnfinishedScan() {
  if (!writer_.joinable()) {
    return;
  }
  writer_.request_stop();
  writer_.join();
  if (!left_) {
    take_away(folder_);
  }
}

void UnfinishedScan::follow(const RangeGrid& grid, int placement_offset) {
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < every_ || refused_ || grid.rows <= copied_rows_) {
    return;
  }
  const std::scoped_lock lock(mutex_);
  if (to_write_) {
    return;  // the disk is behind: the next time takes these along
  }
  last_ = now;
  to_write_ = rows_of(grid, copied_rows_, grid.rows - copied_rows_);
  if (to_write_->nominal) {
    to_write_->nominal->placement += placement_offset;
  }
  copied_rows_ = grid.rows;
  if (!writer_.joinable()) {
    std::error_code told_when_written_to;
    fs::create_directories(folder_, told_when_written_to);  // here: the next scan takes another number
    writer_ = std::jthread([this](const std::stop_token& stop) { write_rows(stop); });
  }
  comes_.notify_one();
}

void UnfinishedScan::remark(const std::string& text) {
  const std::scoped_lock lock(mutex_);
  if (text != remark_) {
    remark_ = text;
    comes_.notify_one();
  }
}

void UnfinishedScan::write_rows(const std::stop_token& stop) {
  Status written;
  if (drive_) {
    written = write_file_atomically(folder_ / kDrive, std::string_view(drives_to_json({{0, *drive_}})));
  }
  std::string remarked;
  for (int number = 0; written;) {
    std::unique_lock lock(mutex_);
    if (!comes_.wait(lock, stop, [&] { return to_write_ || remark_ != remarked; })) {
      return;
    }
    if (remark_ != remarked) {
      remarked = remark_;
      lock.unlock();
      written = write_file_atomically(folder_ / kRemark, std::string_view(remarked));
      continue;
    }
    const RangeGrid rows = std::move(*to_write_);
    lock.unlock();
    written = write_grid_file(rows_file(folder_, number++), rows);
    lock.lock();
    to_write_.reset();
  }
  refused_ = true;
  log_warning("the scan under way cannot be kept before its end: " + written.error().line());
}

std::vector<LeftScan> left_scans(const fs::path& session) {
  std::vector<LeftScan> out;
  for (const int folder_number : numbered_folders(home_of(session))) {
    LeftScan left{.grid = {},
                  .drive = std::nullopt,
                  .remark = {},
                  .folder = home_of(session) / std::to_string(folder_number)};
    for (int number = 0;; ++number) {
      Result<RangeGrid> rows = read_grid_file(rows_file(left.folder, number));
      if (!rows || !append_rows(left.grid, *rows)) {
        break;
      }
    }
    if (const Result<std::string> text = read_whole_file(left.folder / kDrive, kSmallFileBytes)) {
      if (auto drives = parse_drives(*text, (left.folder / kDrive).string()); drives && drives->contains(0)) {
        left.drive = drives->at(0);
      }
    }
    if (const Result<std::string> text = read_whole_file(left.folder / kRemark, kSmallFileBytes)) {
      left.remark = one_line(*text);
    }
    out.push_back(std::move(left));
  }
  return out;
}

bool begins_with(const RangeGrid& grid, const RangeGrid& rows) {
  return grid.cols == rows.cols && grid.rows >= rows.rows &&
         std::equal(rows.valid.begin(), rows.valid.end(), grid.valid.begin()) &&
         std::equal(rows.z.begin(), rows.z.end(), grid.z.begin()) &&
         std::equal(rows.x.begin(), rows.x.end(), grid.x.begin());
}

void forget(const LeftScan& scan) {
  take_away(scan.folder);
}

}  // namespace dubsar
