// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/unfinished_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "acquisition/session_files.h"
#include "core/grid_rows.h"
#include "core/log.h"
#include "core/utf8.h"
#include "formats/atomic_file.h"
#include "formats/files_below.h"
#include "formats/grid_file.h"
#include "formats/refusal.h"
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

std::string name_of_rows(int number) {
  return fmt::format("{:04}.grid", number);
}
std::string name_of_scan(int number) {
  return std::to_string(number);
}

/// The numbers of what lies there under such names, ascending; whatever else does is not ours.
std::vector<int> numbers_in(const fs::path& home, std::string (*name_of)(int)) {
  std::vector<int> out;
  std::error_code ignored;
  for (fs::directory_iterator it(home, ignored), end; !ignored && it != end; it.increment(ignored)) {
    const std::string name = it->path().filename().string();
    const std::string digits = name.substr(0, name.find('.'));
    if (!digits.empty() && digits.size() < 9 &&
        std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '9'; }) &&
        name_of(std::stoi(digits)) == name) {
      out.push_back(std::stoi(digits));
    }
  }
  std::ranges::sort(out);
  return out;
}

fs::path next_folder(const fs::path& session) {
  const std::vector<int> there = numbers_in(home_of(session), name_of_scan);
  return home_of(session) / std::to_string(there.empty() ? 1 : there.back() + 1);
}

/// The names of a scan's folder, and of the one that it lies in, survive a power loss after this. Not where
/// they are made: rows come in meanwhile.
Status sync_names_of(const fs::path& folder, std::error_code making) {
  if (making) {
    return refused(folder, "cannot make the folder", making.value(),
                   "choose a folder that can be written to");
  }
  const fs::path home = folder.parent_path();
  if (Status synced = sync_folder(home.parent_path()); !synced) {
    return synced;
  }
  return sync_folder(home);
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
    std::error_code error;
    fs::create_directories(folder_, error);  // here: the next scan takes another number
    writer_ = std::jthread([this, error](const std::stop_token& stop) { write_rows(stop, error); });
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

void UnfinishedScan::write_rows(const std::stop_token& stop, std::error_code making) {
  Status written = sync_names_of(folder_, making);
  if (written && drive_) {
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
    written = write_grid_file(folder_ / name_of_rows(number++), rows);
    lock.lock();
    to_write_.reset();
  }
  refused_ = true;
  log_warning("the scan under way cannot be kept before its end: " + written.error().line());
}

namespace {

/// One behind what is missing or damaged, or one that is not as wide, begins a part of its own.
void read_rows(LeftScan& left) {
  int next = 0;
  bool goes_on = false;
  for (const int number : numbers_in(left.folder, name_of_rows)) {
    if (number > next) {
      left.unread.push_back({ErrorKind::kBadInput, "missing", (left.folder / name_of_rows(next)).string(),
                             "bring it back from a copy"});
      goes_on = false;
    }
    next = number + 1;
    Result<RangeGrid> rows = read_grid_file(left.folder / name_of_rows(number));
    if (!rows) {
      left.unread.push_back(std::move(rows.error()));
      goes_on = false;
      continue;
    }
    if (!goes_on || !append_rows(left.parts.back(), *rows)) {
      left.parts.push_back(std::move(*rows));
    }
    goes_on = true;
  }
}

/// What is said of it beside the rows; nothing where nothing was.
std::optional<std::string> text_of(LeftScan& left, const char* name) {
  const fs::path file = left.folder / name;
  std::error_code unknown;
  if (!fs::exists(file, unknown) && !unknown) {
    return std::nullopt;
  }
  Result<std::string> text = read_whole_file(file, kSmallFileBytes);
  if (!text) {
    left.unread.push_back(std::move(text.error()));
    return std::nullopt;
  }
  return std::move(*text);
}

}  // namespace

int LeftScan::rows() const {
  int out = 0;
  for (const RangeGrid& part : parts) {
    out += part.valid_count() > 0 ? part.rows : 0;
  }
  return out;
}

std::vector<LeftScan> left_scans(const fs::path& session) {
  std::vector<LeftScan> out;
  for (const int number : numbers_in(home_of(session), name_of_scan)) {
    LeftScan& left = out.emplace_back();
    left.folder = home_of(session) / name_of_scan(number);
    if (const Status readable = check_folder_can_be_read(left.folder); !readable) {
      left.unread.push_back(readable.error());
    }
    read_rows(left);
    if (const std::optional<std::string> text = text_of(left, kDrive)) {
      auto drives = parse_drives(*text, (left.folder / kDrive).string());
      if (!drives) {
        left.unread.push_back(std::move(drives.error()));
      } else if (drives->contains(0)) {
        left.drive = drives->at(0);
      }
    }
    if (const std::optional<std::string> text = text_of(left, kRemark)) {
      left.remark = one_line(*text);
    }
    for (Error& error : left.unread) {
      error.where = fs::path(error.where).lexically_relative(session).generic_string();
    }
  }
  return out;
}

bool holds(const RangeGrid& grid, const RangeGrid& rows) {
  for (int first = 0; grid.cols == rows.cols && first + rows.rows <= grid.rows; ++first) {
    const std::ptrdiff_t begin = std::ptrdiff_t{first} * grid.cols;
    const auto same = [begin](const auto& some, const auto& all) {
      return std::equal(some.begin(), some.end(), all.begin() + begin);
    };
    if (same(rows.valid, grid.valid) && same(rows.z, grid.z) && same(rows.x, grid.x)) {
      return true;
    }
  }
  return false;
}

void forget(const LeftScan& scan) {
  take_away(scan.folder);
}

Result<fs::path> set_aside(const LeftScan& scan) {
  return session::move_aside(scan.folder);
}

}  // namespace dubsar
