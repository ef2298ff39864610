// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/session_log.h"

#include <fstream>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace dubsar::session {

namespace {

constexpr std::size_t kHeaderBytes = 32;
constexpr std::size_t kFrameHeadBytes = 24;
constexpr std::uint32_t kMagic = 0x377f0682U;  ///< its last bit says how words are read for the checksums
constexpr std::uint32_t kLeastPage = 512;
constexpr std::uint32_t kMostPage = 65536;

using Bytes = std::span<const char>;

std::uint32_t big_endian(Bytes bytes, std::size_t at) {
  std::uint32_t out = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    out = (out << 8U) | static_cast<unsigned char>(bytes[at + i]);
  }
  return out;
}

std::uint32_t little_endian(Bytes bytes, std::size_t at) {
  std::uint32_t out = 0;
  for (std::size_t i = 4; i > 0; --i) {
    out = (out << 8U) | static_cast<unsigned char>(bytes[at + i - 1]);
  }
  return out;
}

/// Two words, as the format has them: a checksum or a salt.
struct Checksum {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  bool operator==(const Checksum&) const = default;

  /// A whole number of pairs of words.
  void add(Bytes bytes, bool big) {
    for (std::size_t at = 0; at + 8 <= bytes.size(); at += 8) {
      a += (big ? big_endian(bytes, at) : little_endian(bytes, at)) + b;
      b += (big ? big_endian(bytes, at + 4) : little_endian(bytes, at + 4)) + a;
    }
  }
};

Checksum stored(Bytes bytes, std::size_t at) {
  return {big_endian(bytes, at), big_endian(bytes, at + 4)};
}

/// The checksum of a frame that follows one whose checksum is `before`.
Checksum sum_of_frame(Bytes frame, Checksum before, bool big) {
  before.add(frame.first(8), big);
  before.add(frame.subspan(kFrameHeadBytes), big);
  return before;
}

/// Whether a commit ends with this frame. Its mark is the number of pages of the database, which a single bit
/// may be all of: then the checksum tells whether that bit was there.
bool ends_commit(const std::vector<char>& frame, const Checksum& before, bool big) {
  if (big_endian(Bytes(frame), 4) != 0) {
    return true;
  }
  std::vector<char> mended = frame;
  for (int bit = 0; bit < 32; ++bit) {
    char& byte = mended[4 + static_cast<std::size_t>(bit) / 8];
    byte = static_cast<char>(1 << (bit % 8));
    if (sum_of_frame(mended, before, big) == stored(Bytes(mended), 16)) {
      return true;
    }
    byte = 0;
  }
  return false;
}

}  // namespace

Result<LogState> read_log(const std::filesystem::path& path) {
  LogState out;
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error || size == 0) {
    return out;
  }
  out.bytes = static_cast<std::int64_t>(size);
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return bad_input(path.string(), "unreadable", "make it readable");
  }
  std::vector<char> header(kHeaderBytes);
  if (!file.read(header.data(), kHeaderBytes)) {
    return out;  // torn before its first commit
  }
  const bool big = (big_endian(header, 0) & 1U) != 0;
  const std::uint32_t page = big_endian(header, 8);
  if (page < kLeastPage || page > kMostPage || (page & (page - 1)) != 0) {
    // Where frames begin cannot be told any more. A log that short has not had a commit and another one.
    out.lost_commits = size > kHeaderBytes + 2 * (kFrameHeadBytes + kLeastPage) ? 1 : 0;
    return out;
  }
  Checksum running;
  running.add(Bytes(header).first(24), big);
  bool playing = running == stored(header, 24) && (big_endian(header, 0) & ~1U) == kMagic;
  Checksum before = stored(header, 24);
  Checksum salts =
      stored(header, 16);     // the same in every frame of this log, others in what an older one left
  std::int64_t unproven = 0;  // commits behind the damage that no whole frame follows yet
  std::vector<char> frame(kFrameHeadBytes + page);
  for (bool first = true; file.read(frame.data(), static_cast<std::streamsize>(frame.size()));
       first = false) {
    const Bytes bytes(frame);
    if (first && !playing) {
      salts = stored(bytes, 8);  // those of the head cannot be trusted
    }
    const bool whole = salts == stored(bytes, 8) && sum_of_frame(bytes, before, big) == stored(bytes, 16);
    const Checksum previous = std::exchange(before, stored(bytes, 16));
    playing = playing && whole;
    if (playing) {
      ++out.frames;
      out.commits += big_endian(bytes, 4) != 0 ? 1 : 0;
      continue;
    }
    if (whole && !first) {
      out.lost_commits += unproven;
      unproven = 0;
    }
    // What an older log left counts here too, and is never proven: nothing of this log follows it.
    unproven += ends_commit(frame, previous, big) ? 1 : 0;
  }
  return out;
}

Error lost_commits_error(const LogState& log, const std::string& where) {
  return {ErrorKind::kBadInput,
          "the log is damaged: " + std::to_string(log.lost_commits) + " of its changes cannot be read (" +
              std::to_string(log.commits) + " before them can)",
          where,
          "bring the folder back from a copy; the scans themselves are taken in again from their grids"};
}

}  // namespace dubsar::session
