// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/bag.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>

#include "core/parallel.h"
#include "core/utf8.h"
#include "formats/atomic_file.h"
#include "formats/sha2.h"

namespace dubsar {

namespace {

namespace fs = std::filesystem;
constexpr const char* kPayload = "data";

/// A file of the bag by its name in the manifests.
struct Listed {
  std::string name;
  std::uint64_t bytes = 0;
};

Result<std::vector<Listed>> files_below(const fs::path& root, const fs::path& folder) {
  std::vector<Listed> files;
  std::error_code error;
  const auto unreadable = [](const fs::path& path, const std::error_code& why) {
    return fail(ErrorKind::kStorage, why.message(), path.string(), "check the disk");
  };
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code unknown;  // of its own: going on to the next one forgets it
    const fs::file_status status = it->symlink_status(unknown);
    if (!unknown && !fs::is_directory(status) && !fs::is_regular_file(status)) {
      return bad_input(it->path().string(), "a bag holds files and folders only", "take it out");
    }
    const std::uint64_t bytes = !unknown && fs::is_regular_file(status) ? it->file_size(unknown) : 0;
    if (unknown) {
      return unreadable(it->path(), unknown);
    }
    if (fs::is_regular_file(status)) {
      files.push_back({it->path().lexically_relative(root).generic_string(), bytes});
    }
  }
  if (error) {
    return unreadable(folder, error);
  }
  std::ranges::sort(files, {}, &Listed::name);
  return files;
}

/// The largest files first: they decide when the last one is done.
Result<std::string> manifest_of(const fs::path& root, const std::vector<Listed>& files,
                                const JobContext& job) {
  std::vector<std::size_t> order(files.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = i;
  }
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return files[i].bytes; });
  std::vector<std::optional<Result<std::string>>> sums(files.size());
  std::atomic<std::size_t> done{0};
  parallel_for_each_index(
      files.size(),
      [&](std::size_t k) {
        const std::size_t i = order[k];
        sums[i] = sha512_of_file(root / files[i].name, job);
        job.progress("checksums",
                     static_cast<double>(done.fetch_add(1) + 1) / static_cast<double>(files.size()));
      },
      1);
  std::string text;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!*sums[i]) {
      return std::unexpected(sums[i]->error());
    }
    text += **sums[i] + "  " + bag_path(files[i].name) + "\n";
  }
  return text;
}

}  // namespace

std::string bag_path(std::string_view path) {
  std::string out;
  for (const char c : path) {
    switch (c) {
      case '%':
        out += "%25";
        break;
      case '\r':
        out += "%0D";
        break;
      case '\n':
        out += "%0A";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string size_in_words(std::uint64_t bytes) {
  constexpr std::array<const char*, 5> kUnits = {"bytes", "kB", "MB", "GB", "TB"};
  auto size = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; size >= 1000 && unit + 1 < kUnits.size(); ++unit) {
    size /= 1000;
  }
  return fmt::format("{:.{}f} {}", size, unit == 0 ? 0 : 1, kUnits[unit]);
}

Result<BagSize> write_bag_tags(const fs::path& folder, const std::vector<BagField>& info,
                               const JobContext& job) {
  const auto payload = files_below(folder, folder / kPayload);
  if (!payload) {
    return std::unexpected(payload.error());
  }
  if (payload->empty()) {
    return bad_input((folder / kPayload).string(), "a bag without a payload", "put files there first");
  }
  const Result<std::string> manifest = manifest_of(folder, *payload, job);
  if (!manifest) {
    return std::unexpected(manifest.error());
  }
  BagSize size;
  size.files = payload->size();
  for (const Listed& file : *payload) {
    size.bytes += file.bytes;
  }
  std::string fields;
  for (const BagField& field : info) {
    if (!field.value.empty()) {
      fields += field.label + ": " + one_line(field.value) + "\n";
    }
  }
  fields += "Bag-Size: " + size_in_words(size.bytes) + "\n";
  fields += fmt::format("Payload-Oxum: {}.{}\n", size.bytes, size.files);
  const auto tag = [&](const char* name, const std::string& text) {
    return write_file_atomically(folder / name, text);
  };
  for (const Status& written : {tag("bagit.txt", "BagIt-Version: 1.0\nTag-File-Character-Encoding: UTF-8\n"),
                                tag("bag-info.txt", fields), tag("manifest-sha512.txt", *manifest)}) {
    if (!written) {
      return std::unexpected(written.error());
    }
  }
  auto tags = files_below(folder, folder);
  if (!tags) {
    return std::unexpected(tags.error());
  }
  std::erase_if(*tags, [](const Listed& file) {
    return file.name.starts_with(std::string(kPayload) + "/") || file.name.starts_with("tagmanifest-");
  });
  const Result<std::string> tag_manifest = manifest_of(folder, *tags, job);
  if (!tag_manifest) {
    return std::unexpected(tag_manifest.error());
  }
  if (const Status written = tag("tagmanifest-sha512.txt", *tag_manifest); !written) {
    return std::unexpected(written.error());
  }
  return size;
}

}  // namespace dubsar
