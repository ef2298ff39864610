// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/bag_repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <span>

#include "formats/atomic_file.h"
#include "formats/bag_text.h"
#include "formats/make_folder.h"
#include "formats/same_bytes.h"
#include "formats/sha2.h"

namespace dubsar {

namespace fs = std::filesystem;

namespace {

constexpr const char* kManifest = "manifest-sha512.txt";
constexpr const char* kTagManifest = "tagmanifest-sha512.txt";

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

/// The same package: what is said of every file of it, or of that list itself, is the same here and there.
bool is_of_one_package(const fs::path& bag, const fs::path& copy) {
  return have_same_bytes(bag / kManifest, copy / kManifest, kMaxBagTextBytes) ||
         have_same_bytes(bag / kTagManifest, copy / kTagManifest, kMaxBagTextBytes);
}

/// A file of the bag itself: what a link leads to is none.
bool is_here(const fs::path& bag, const std::string& name) {
  std::error_code none;
  fs::path at = bag;
  for (const fs::path& part : fs::path(name)) {
    at /= part;
    if (fs::is_symlink(fs::symlink_status(at, none))) {
      return false;
    }
  }
  return fs::is_regular_file(at, none);
}

/// Files of the copy that are as the package says and that the bag lacks so.
std::set<std::string> wanted_of(const fs::path& bag, const BagReport& found, const fs::path& copy,
                                const BagReport& there, const JobContext& job) {
  std::set<std::string> out;
  // A list that is damaged there would call damaged files whole.
  if (!has(there.whole, kManifest)) {
    return out;
  }
  std::ranges::set_difference(std::set(there.whole.begin(), there.whole.end()),
                              std::set(found.whole.begin(), found.whole.end()),
                              std::inserter(out, out.end()));
  if (there.ok()) {
    out.insert(kTagManifest);  // no list has it: a whole bag's is right
  }
  std::erase_if(out, [&](const std::string& name) {
    std::error_code none;
    const Result<std::string> here = sha512_of_file(bag / name, job);
    const Result<std::string> whole = sha512_of_file(copy / name, job);
    return !fs::is_regular_file(copy / name, none) ||
           (is_here(bag, name) && here && whole && *here == *whole);
  });
  return out;
}

/// A folder beside the bag that nothing lies under yet.
fs::path aside_of(const fs::path& bag) {
  const fs::path whole = fs::weakly_canonical(bag);
  for (int n = 1;; ++n) {
    fs::path out = whole.string() + fmt::format(".damaged-{}", n);
    std::error_code none;
    if (!fs::exists(fs::symlink_status(out, none))) {
      return out;
    }
  }
}

Status copy_file_to(const fs::path& from, const fs::path& to) {
  return write_file_atomically(to, [&](const ByteSink& sink) -> Status {
    Result<std::ifstream> in = open_stored_file(from);
    if (!in) {
      return std::unexpected(in.error());
    }
    std::vector<char> block(std::size_t{1} << 20U);
    while (in->read(block.data(), static_cast<std::streamsize>(block.size())) || in->gcount() > 0) {
      const std::span<const char> read(block.data(), static_cast<std::size_t>(in->gcount()));
      if (Status sunk = sink(std::as_bytes(read)); !sunk) {
        return sunk;
      }
    }
    if (in->bad()) {
      return fail(ErrorKind::kStorage, "cannot be read to its end", from.string());
    }
    return {};
  });
}

Status put_aside(const fs::path& file, const fs::path& to) {
  std::error_code error;
  const fs::file_status is = fs::symlink_status(file, error);
  if (!fs::exists(is)) {
    return {};
  }
  if (const Status made = make_folder(to.parent_path()); !made) {
    return made;
  }
  // A file is under both names until the whole one takes its place, where the disk can do that.
  if (fs::is_regular_file(is)) {
    fs::create_hard_link(file, to, error);
  }
  if (error || !fs::is_regular_file(is)) {
    fs::rename(file, to, error);
  }
  if (error) {
    return fail(ErrorKind::kStorage, "cannot be set aside: " + error.message(), file.string());
  }
  return sync_folder(to.parent_path());
}

/// What lies where a folder of the bag should be (a link leads out of it) goes aside, too.
Status make_way(const fs::path& bag, const std::string& name, const fs::path& aside) {
  fs::path below;
  for (const fs::path& part : fs::path(name).parent_path()) {
    below /= part;
    std::error_code none;
    if (!fs::is_directory(fs::symlink_status(bag / below, none))) {
      if (const Status kept = put_aside(bag / below, aside / below); !kept) {
        return kept;
      }
    }
  }
  if (const Status kept = put_aside(bag / name, aside / name); !kept) {
    return kept;
  }
  return make_folder((bag / name).parent_path());
}

}  // namespace

Result<BagRepair> repair_bag(const fs::path& bag, const BagReport& found, const fs::path& copy,
                             JobContext& job) {
  if (!is_bag(copy)) {
    return fail(ErrorKind::kUsage, "the copy is no bag", copy.string(),
                "name the folder that the bag was copied to");
  }
  if (!is_of_one_package(bag, copy)) {
    return fail(ErrorKind::kUsage, "the copy is of another package: its checksums are others", copy.string(),
                "name a copy of this very bag");
  }
  const Result<BagReport> there = check_bag(copy, job);
  if (!there) {
    return std::unexpected(there.error());
  }
  BagRepair out;
  const fs::path aside = aside_of(bag);
  for (const std::string& name : wanted_of(bag, found, copy, *there, job)) {
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "repair cancelled", bag.string());
    }
    if (const Status free = make_way(bag, name, aside); !free) {
      return std::unexpected(free.error());
    }
    if (const Status written = copy_file_to(copy / name, bag / name); !written) {
      return std::unexpected(written.error());
    }
    out.restored.push_back(name);
  }
  std::error_code none;
  if (fs::exists(aside, none)) {
    out.set_aside = aside;
  }
  return out;
}

}  // namespace dubsar
