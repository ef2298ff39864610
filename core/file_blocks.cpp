// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/file_blocks.h"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/statfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <string_view>

#include "core/memory_left.h"

namespace dubsar {

namespace {

constexpr std::size_t kPage = 4096;

std::uintptr_t address_of(const void* memory) noexcept {
  return reinterpret_cast<std::uintptr_t>(memory);
}

void unmap(void* memory, std::size_t bytes) noexcept {
  if (bytes > 0) {
    ::munmap(memory, bytes);
  }
}

struct Block {
  std::uintptr_t at = 0;  ///< 0: the place is free; kGone: was taken once, look on
  std::size_t bytes = 0;
};
constexpr std::uintptr_t kGone = 1;

/// Where the blocks lie: a table of fixed size, since whoever asks is allocating.
class BlockTable {
 public:
  bool insert(Block block) noexcept {
    const std::scoped_lock lock(mutex_);
    if (count_ * 2 >= places_.size()) {
      return false;
    }
    std::size_t i = place_of(block.at);
    while (places_[i].at > kGone) {
      i = (i + 1) % places_.size();
    }
    places_[i] = block;
    ++count_;
    bytes_ += block.bytes;
    most_bytes_ = std::max(most_bytes_.load(), bytes_);
    return true;
  }
  /// Its bytes; 0 when it is not here.
  std::size_t take(std::uintptr_t at) noexcept {
    const std::scoped_lock lock(mutex_);
    std::size_t i = place_of(at);
    for (std::size_t looked = 0; looked < places_.size() && places_[i].at != 0; ++looked) {
      if (places_[i].at == at) {
        const std::size_t bytes = places_[i].bytes;
        places_[i].at = kGone;
        bytes_ -= bytes;
        if (--count_ == 0) {
          places_.fill({});  // else places that were taken once would make every look longer
        }
        return bytes;
      }
      i = (i + 1) % places_.size();
    }
    return 0;
  }
  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }
  [[nodiscard]] std::size_t most_bytes() const noexcept { return most_bytes_; }

 private:
  std::size_t place_of(std::uintptr_t at) const noexcept {
    return static_cast<std::size_t>((at / kPage) * 0x9E3779B97F4A7C15ULL >> 40U) % places_.size();
  }

  std::mutex mutex_;
  std::array<Block, 1U << 15U> places_{};
  std::atomic<std::size_t> count_ = 0;
  std::size_t bytes_ = 0;
  std::atomic<std::size_t> most_bytes_ = 0;
};
constinit BlockTable table;

/// A file without a name on a disk that is one, or -1.
int open_file() noexcept {
  const char* const asked_for = std::getenv("TMPDIR");
  for (const char* const folder : {asked_for, "/var/tmp"}) {
    struct statfs disk {};
    if (folder == nullptr || ::statfs(folder, &disk) != 0 || disk.f_type == TMPFS_MAGIC) {
      continue;
    }
    const int file = ::open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (file >= 0) {
      return file;
    }
  }
  return -1;
}

enum class Choice { kByMemoryLeft, kFiles, kMemory };

Choice choice_of_environment() noexcept {
  const char* const value = std::getenv("DUBSAR_ARRAYS");
  const std::string_view word = value == nullptr ? "" : value;
  return word == "files" ? Choice::kFiles : word == "memory" ? Choice::kMemory : Choice::kByMemoryLeft;
}

/// Bytes that may be taken before the kernel is asked anew: while there is plenty it is hardly ever asked.
std::atomic<std::int64_t> granted = 0;

}  // namespace

bool belongs_in_file(std::size_t bytes) noexcept {
  static const Choice choice = choice_of_environment();
  if (choice != Choice::kByMemoryLeft) {
    return choice == Choice::kFiles;
  }
  const auto wanted = static_cast<std::int64_t>(bytes);
  if (granted.fetch_sub(wanted) >= wanted) {
    return false;
  }
  const MemoryLeft left = memory_left();
  const std::int64_t spare = left.free_bytes - left.total_bytes / 4;
  if (left.total_bytes > 0 && spare < wanted) {
    granted = 0;
    return true;
  }
  granted = (spare - wanted) / 4;
  return false;
}

void* allocate_file_block(std::size_t bytes, std::size_t alignment) noexcept {
  const std::size_t whole = (bytes + kPage - 1) / kPage * kPage;
  const std::size_t spare = alignment > kPage ? alignment : 0;
  const int file = open_file();
  if (file < 0 || whole < bytes) {
    return nullptr;
  }
  void* block = nullptr;
  // Room is taken at once: a disk that turns out full at a write in mid-work would end the program.
  if (::posix_fallocate(file, 0, static_cast<off_t>(whole)) == 0) {
    void* const around = ::mmap(nullptr, whole + spare, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (around != MAP_FAILED) {
      char* const first = static_cast<char*>(around);
      const std::size_t before = spare == 0 ? 0 : (spare - address_of(around) % spare) % spare;
      unmap(first, before);
      unmap(first + before + whole, spare - before);
      block = ::mmap(first + before, whole, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file, 0);
      if (block == MAP_FAILED || !table.insert({address_of(block), whole})) {
        unmap(first + before, whole);
        block = nullptr;
      }
    }
  }
  ::close(file);  // the mapping holds it
  return block;
}

bool free_file_block(void* block) noexcept {
  const std::uintptr_t at = address_of(block);
  if (at == 0 || at % kPage != 0 || table.empty()) {
    return false;
  }
  const std::size_t bytes = table.take(at);
  unmap(block, bytes);
  return bytes > 0;
}

std::size_t most_file_block_bytes() noexcept {
  return table.most_bytes();
}

}  // namespace dubsar
