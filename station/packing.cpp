// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/packing.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "analysis/wedges.h"
#include "archive/staged_folder.h"
#include "formats/atomic_file.h"
#include "formats/files_below.h"
#include "formats/json_node.h"
#include "formats/resolved_place.h"
#include "station/done_stamp.h"
#include "station/earlier_package.h"
#include "station/place_outside.h"
#include "station/session_name.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

/// What decides what is in the package, beside the session.
std::string parameters_of(const PackageOptions& options) {
  nlohmann::ordered_json json{{"base_url", options.base_url},
                              {"ground", options.white_ground ? "white" : "black"}};
  std::vector<std::string> without;
  without.reserve(options.without.size());
  for (const PackagePart part : options.without) {
    without.emplace_back(to_string(part));
  }
  std::ranges::sort(without);
  json["without"] = without;
  if (!options.without.contains(PackagePart::kWedges)) {
    json["wedge_method"] = kWedgeMethod;
  }
  if (options.draco) {  // said only then: stamps of before know nothing of it
    json["draco"] = true;
  }
  return json.dump();
}

/// A package that is made again from the same session is found done (docs/collections.md).
Result<StampedWork> begin_work(const PackRequest& request, const JobContext& job) {
  const auto passes_over = [](const fs::path& file) {
    const std::string name = file.filename().string();
    return name == "session.lock" || name.ends_with("-shm") || name.starts_with(kTemporaryPrefix);
  };
  FoundBelow inputs = readable_files_below(request.session, passes_over);
  // What cannot be read is damage like any other: it is told, and the rest packed.
  for (const Error& unreadable : inputs.unreadable) {
    inputs.files.emplace_back(unreadable.where);
  }
  std::ranges::sort(inputs.files);
  return StampedWork::begin(stamp_beside(request.to), "export", parameters_of(request.package), inputs.files,
                            job, true);
}

/// The stamp as it lies there; empty where none does.
std::string stamp_text(const StampedWork& work) {
  std::error_code none;
  const Result<std::string> text = fs::is_regular_file(work.stamp(), none)
                                       ? read_whole_file(work.stamp(), kMaxJsonBytes)
                                       : Result<std::string>();
  return text.value_or(std::string());
}

/// Nothing was done: the stamp says again what it said before, for what lies there is what lay there.
void take_back(const StampedWork& work, const std::string& before) {
  if (before.empty() || !write_file_atomically(work.stamp(), before)) {
    (void)work.start();  // a stamp that stays all the same fits nothing that is there
  }
}

}  // namespace

Result<Packing> pack_session(const PackRequest& asked, JobContext& job) {
  if (const Status there = check_goes_up_from_folders(asked.to); !there) {
    return std::unexpected(there.error());
  }
  PackRequest request = asked;
  request.to = resolved_place(asked.to);  // one place to be checked and written
  if (const Status outside = check_place_of_package(request.to); !outside) {
    return std::unexpected(outside.error());
  }
  if (const Status place = check_no_disk_is_mounted_at(request.to); !place) {
    return std::unexpected(place.error());
  }
  std::error_code ignored;
  std::optional<StampedWork> work;
  PackageOptions options = request.package;
  if (SessionStore::is_session(request.session)) {
    Result<StampedWork> begun = begin_work(request, job);
    if (!begun) {
      return std::unexpected(begun.error());
    }
    work = std::move(*begun);
    const Result<bool> done = options.replace ? false : work->done(job);
    if (!done) {
      return std::unexpected(done.error());
    }
    if (*done) {
      const std::optional<DoneStamp> known = read_done_stamp(work->stamp(), "export");
      if (const Status whole = check_nothing_added(request.to, known.value_or(DoneStamp())); !whole) {
        return std::unexpected(whole.error());
      }
      return Packing{.done_before = true, .package = {}};
    }
    // Whatever is replaced keeps its stamp until the new one is whole.
    if (!fs::exists(request.to, ignored)) {
      if (const Status started = work->start(); !started) {
        return std::unexpected(started.error());
      }
    } else if (!options.replace) {
      const Result<bool> earlier =
          request.update ? is_earlier_package(request.to, request.session, *work, job) : Result<bool>(false);
      if (!earlier) {
        return std::unexpected(earlier.error());
      }
      options.replace = *earlier;
      if (const Status known =
              *earlier ? Status() : check_is_not_packed(request.to, request.session, *work, job);
          !known) {
        return std::unexpected(known.error());
      }
    }
  }
  bool stamped = false;
  const std::string before = work ? stamp_text(*work) : std::string();
  if (work) {
    options.before_publishing = [&](const fs::path& staged) -> Status {
      const auto outputs = files_below(staged);
      if (!outputs) {
        return std::unexpected(outputs.error());
      }
      stamped = true;
      return work->finish_staged(*outputs, staged, request.to, job);
    };
  }
  Result<Package> package = write_package(request.session, request.to, options, job);
  if (!package) {
    if (stamped) {
      take_back(*work, before);
    }
    return std::unexpected(package.error());
  }
  return Packing{.done_before = false, .package = std::move(*package)};
}

Result<bool> is_packed(const fs::path& session, const fs::path& package, const JobContext& job) {
  const fs::path place = resolved_place(package);
  const std::optional<DoneStamp> known = read_done_stamp(stamp_beside(place), "export");
  if (!known || known->outputs.empty()) {
    return false;
  }
  const Result<StampedWork> now = begin_work({.session = session, .to = place, .package = {}}, job);
  if (!now) {
    return std::unexpected(now.error());
  }
  std::error_code error;
  return known->inputs == now->inputs() && std::ranges::all_of(known->outputs, [&](const StampedFile& file) {
           const auto bytes = fs::file_size(now->stamp().parent_path() / file.name, error);
           return !error && bytes == file.bytes;
         });
}

fs::path usual_package_of(const fs::path& session) {
  return fs::path(whole_name(session).string() + ".results") / "package";
}

}  // namespace dubsar
