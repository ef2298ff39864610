// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/memory_left.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string_view>

namespace dubsar {

namespace {

/// The first kilobytes of a file of the kernel's, read where nothing may be allocated.
struct SmallFile {
  std::array<char, 8192> bytes{};
  std::size_t size = 0;

  SmallFile(const char* root, const char* folder, std::string_view path, const char* name) noexcept {
    std::array<char, 1024> whole{};
    const int length = std::snprintf(whole.data(), whole.size(), "%s%s%.*s%s", root, folder,
                                     static_cast<int>(path.size()), path.data(), name);
    if (length < 0 || static_cast<std::size_t>(length) >= whole.size()) {
      return;
    }
    const int file = ::open(whole.data(), O_RDONLY | O_CLOEXEC);
    if (file < 0) {
      return;
    }
    // One byte stays zero: what is read as a number ends there.
    while (size + 1 < bytes.size()) {
      const ssize_t got = ::read(file, bytes.data() + size, bytes.size() - 1 - size);
      if (got <= 0) {
        break;
      }
      size += static_cast<std::size_t>(got);
    }
    ::close(file);
  }

  [[nodiscard]] std::string_view text() const noexcept { return {bytes.data(), size}; }

  /// The number at the head of the file, or after a word at the beginning of one of its lines.
  [[nodiscard]] std::optional<std::int64_t> number(std::string_view after = {}) const noexcept {
    std::string_view rest = text();
    while (!rest.empty()) {
      if (rest.starts_with(after)) {
        const char* const from = rest.data() + after.size();
        char* end = nullptr;
        const long long value = std::strtoll(from, &end, 10);
        return end == from ? std::nullopt : std::optional<std::int64_t>(value);
      }
      const std::size_t line = rest.find('\n');
      rest.remove_prefix(line == std::string_view::npos ? rest.size() : line + 1);
    }
    return std::nullopt;
  }
};

void narrow(MemoryLeft& left, std::int64_t limit, std::int64_t used, std::int64_t reclaimable) noexcept {
  left.total_bytes = std::min(left.total_bytes, limit);
  left.free_bytes = std::min(left.free_bytes, std::max<std::int64_t>(limit - used + reclaimable, 0));
}

/// A hierarchy of control groups: where it is mounted, and what its files are called.
struct Hierarchy {
  std::string_view mark;  ///< of its line in /proc/self/cgroup, before the path
  const char* folder;
  const char* limit;
  const char* used;
  std::string_view inactive, active;  ///< pages of files, in memory.stat, with those of the groups within
};
constexpr Hierarchy kVersions[] = {
    {":memory:", "/sys/fs/cgroup/memory", "/memory.limit_in_bytes", "/memory.usage_in_bytes",
     "total_inactive_file ", "total_active_file "},
    {"0::", "/sys/fs/cgroup", "/memory.max", "/memory.current", "inactive_file ", "active_file "},
};

}  // namespace

MemoryLeft memory_left(const char* root) noexcept {
  const SmallFile machine(root, "/proc", "", "/meminfo");
  const auto total_kib = machine.number("MemTotal:");
  const auto free_kib = machine.number("MemAvailable:");
  if (!total_kib || !free_kib) {
    return {};
  }
  MemoryLeft left{*total_kib * 1024, *free_kib * 1024};
  const SmallFile groups(root, "/proc", "", "/self/cgroup");
  for (const Hierarchy& version : kVersions) {
    const std::size_t at = groups.text().find(version.mark);
    if (at == std::string_view::npos) {
      continue;
    }
    std::string_view path = groups.text().substr(at + version.mark.size());
    path = path.substr(0, path.find('\n'));
    for (;;) {
      path = path == "/" ? std::string_view() : path;
      const auto limit = SmallFile(root, version.folder, path, version.limit).number();
      const auto used = SmallFile(root, version.folder, path, version.used).number();
      if (limit && used) {  // no limit reads "max", or as more than any machine has
        const SmallFile pages(root, version.folder, path, "/memory.stat");
        narrow(left, *limit, *used,
               pages.number(version.inactive).value_or(0) + pages.number(version.active).value_or(0));
      }
      if (path.empty()) {
        break;
      }
      path = path.substr(0, path.rfind('/'));
    }
  }
  return left;
}

}  // namespace dubsar
