// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/station/support/byte_flips.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <sstream>

#include "acquisition/pose_json.h"
#include "acquisition/session_files.h"
#include "acquisition/session_store.h"
#include "acquisition/sign_off_log.h"
#include "formats/atomic_file.h"
#include "formats/bag_check.h"
#include "tests/acquisition/session_support.h"

namespace dubsar::test {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t kEnd = 64;  ///< bytes at either end of a file that are always tried

bool passes_session(const fs::path& folder, JobContext& job) {
  const Result<SessionStore> store = SessionStore::open(folder, SessionStore::Access::kReadOnly);
  if (!store) {
    return false;
  }
  const Result<VerifyReport> report = store->verify(job);
  const Result<SignOffLog> signed_off = read_sign_offs(*store, job);
  return report && report->ok() && signed_off && signed_off->damage.empty() &&
         (signed_off->sign_offs.empty() || signed_off->sign_offs.back().holds());
}

std::set<std::uintmax_t> places(std::uintmax_t bytes, std::uintmax_t wanted, Random& random) {
  std::set<std::uintmax_t> out;
  const std::uintmax_t at_each_end = bytes <= wanted ? bytes : std::min(kEnd, wanted / 2);
  for (std::uintmax_t i = 0; i < at_each_end; ++i) {
    out.insert({i, bytes - 1 - i});
  }
  while (out.size() < std::min(bytes, wanted)) {
    out.insert(random.below(bytes));
  }
  return out;
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file() && name != session::kLock && !name.ends_with("-shm")) {
      out.push_back(entry.path());
    }
  }
  std::ranges::sort(out);
  return out;
}

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

template <typename T>
std::vector<T> or_none(Result<std::vector<T>> read) {
  return read ? std::move(*read) : std::vector<T>();
}

/// Every row of every table, through the functions that the program reads them with.
std::string rows_of(const fs::path& folder) {
  std::ostringstream out;
  const Result<SessionStore> store = SessionStore::open(folder, SessionStore::Access::kReadOnly);
  if (!store) {
    return store.error().line();
  }
  for (const StoredScan& scan : or_none(store->scans())) {
    out << scan.id << scan.file << scan.rows << scan.cols << scan.samples << scan.spacing_mm
        << scan.timestamp_ns << scan.device << scan.source << scan.note << scan.dropped << scan.damaged
        << '\n';
    if (const auto flags = store->load_flags(scan.id); flags && *flags) {
      out.write(reinterpret_cast<const char*>((*flags)->data()),
                static_cast<std::streamsize>((*flags)->size()));
    }
  }
  for (const ScanPose& pose : or_none(store->poses())) {
    out << session::json_from_pose(pose) << '\n';
  }
  for (const std::string& name : or_none(store->document_names())) {
    const auto text = store->load_document(name);
    out << name << (text && *text ? **text : "nothing") << '\n';
  }
  for (const SessionEvent& event : or_none(store->events())) {
    out << event.number << event.time_ns << event.kind << event.json << '\n';
  }
  return out.str();
}

}  // namespace

std::string what_it_says(const fs::path& folder) {
  std::string out = SessionStore::is_session(folder) ? rows_of(folder) : "";
  for (const fs::path& file : files_in(folder)) {
    const std::string name = file.filename().string();
    if (!name.starts_with(session::kDatabase)) {
      const std::string bytes = read_whole_file(file).value_or("cannot be read");
      out += name + (name.find("manifest-") == std::string::npos ? bytes : lower_case(bytes));
    }
  }
  return out;
}

bool passes_verification(const fs::path& folder) {
  JobContext job;
  if (SessionStore::is_session(folder)) {
    return passes_session(folder, job);
  }
  if (!is_bag(folder)) {
    return false;
  }
  const Result<BagReport> report = check_bag(folder, job);
  return report && report->ok();
}

std::map<std::string, FlipTally> flip_bytes(const fs::path& folder, std::uintmax_t per_file, Random& random) {
  std::map<std::string, FlipTally> out;
  const std::string before = what_it_says(folder);
  for (const fs::path& file : files_in(folder)) {
    FlipTally& tally = out[file.lexically_relative(folder).generic_string()];
    tally.bytes = fs::file_size(file);
    for (const std::uintmax_t at : places(tally.bytes, per_file, random)) {
      const int mask = 1 << random.below(8);
      flip_byte(file, at, mask);
      if (passes_verification(folder)) {
        if (what_it_says(folder) == before) {
          ++tally.idle;
        } else {
          tally.missed.push_back(at);
        }
      }
      flip_byte(file, at, mask);
      ++tally.tried;
    }
  }
  return out;
}

}  // namespace dubsar::test
