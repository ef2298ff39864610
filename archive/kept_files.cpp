// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/kept_files.h"

#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "formats/atomic_file.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;

std::unexpected<Error> storage(const fs::path& path, const std::string& doing, const std::string& why) {
  return fail(ErrorKind::kStorage, doing + ": " + why, path.string(),
              "nothing was replaced: move it elsewhere yourself, or choose another folder");
}

Result<std::vector<fs::path>> all_but(const std::set<std::string>& own, const fs::path& bag) {
  std::vector<fs::path> out;
  std::error_code error;
  std::error_code ignored;
  for (fs::recursive_directory_iterator it(bag, error), end; !error && it != end; it.increment(error)) {
    const fs::path name = it->path().lexically_relative(bag);
    if ((it->is_symlink(ignored) || !it->is_directory(ignored)) && !own.contains(name.generic_string())) {
      out.push_back(name);
    }
  }
  if (error) {
    return storage(bag, "not all of its files can be listed", error.message());
  }
  return out;
}

Result<fs::path> new_folder_beside(const fs::path& bag) {
  for (int number = 1;; ++number) {
    const fs::path folder = bag.string() + ".kept-" + std::to_string(number);
    std::error_code error;
    if (fs::create_directory(folder, error)) {
      return folder;
    }
    if (error) {
      return storage(folder, "cannot make the folder", error.message());
    }
  }
}

Status copy_durably(const fs::path& from, const fs::path& to) {
  Result<std::ifstream> in = open_stored_file(from);
  if (!in) {
    return std::unexpected(in.error());
  }
  return write_file_atomically(to, [&](const ByteSink& sink) -> Status {
    std::vector<char> piece(std::size_t{1} << 20U);
    while (in->read(piece.data(), static_cast<std::streamsize>(piece.size())) || in->gcount() > 0) {
      const auto bytes = static_cast<std::size_t>(in->gcount());
      if (const Status taken = sink(std::as_bytes(std::span(piece.data(), bytes))); !taken) {
        return taken;
      }
    }
    return in->bad() ? storage(from, "cannot be read", "the disk refused") : Status();
  });
}

Status keep_one(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  if (error) {
    return storage(to.parent_path(), "cannot make the folder", error.message());
  }
  fs::create_hard_link(from, to, error);
  if (!error) {
    return {};
  }
  if (fs::is_symlink(from, error)) {
    fs::copy_symlink(from, to, error);
    return error ? storage(from, "cannot be kept", error.message()) : Status();
  }
  return copy_durably(from, to);
}

Status keep_all(const fs::path& bag, const std::vector<fs::path>& names, const fs::path& folder,
                const JobContext& job) {
  for (const fs::path& name : names) {
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "stopped");
    }
    if (const Status kept = keep_one(bag / name, folder / name); !kept) {
      return kept;
    }
  }
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (std::error_code ignored; it->is_directory(ignored) && !it->is_symlink(ignored)) {
      if (const Status synced = sync_folder(it->path()); !synced) {
        return synced;
      }
    }
  }
  if (const Status synced = sync_folder(folder); !synced) {
    return synced;
  }
  return sync_folder(folder_of(folder));
}

}  // namespace

std::string sentence_of(const KeptFiles& kept) {
  return kept.files == 0
             ? ""
             : "what was put into the earlier package, or changed in it, is kept in " + kept.folder.string();
}

Result<KeptFiles> keep_all_but(const std::set<std::string>& own, const fs::path& bag, const JobContext& job) {
  const Result<std::vector<fs::path>> names = all_but(own, bag);
  if (!names) {
    return std::unexpected(names.error());
  }
  if (names->empty()) {
    return KeptFiles{};
  }
  const Result<fs::path> folder = new_folder_beside(bag);
  if (!folder) {
    return std::unexpected(folder.error());
  }
  if (const Status kept = keep_all(bag, *names, *folder, job); !kept) {
    std::error_code ignored;
    fs::remove_all(*folder, ignored);
    return std::unexpected(kept.error());
  }
  return KeptFiles{*folder, names->size()};
}

}  // namespace dubsar
