// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "core/result.h"

namespace dubsar {

/// Takes the next bytes of a file that is being written.
using ByteSink = std::function<Status(std::span<const std::byte>)>;
/// Writes a whole file into the sink; an error that it returns is handed on and nothing is kept.
using ByteProducer = std::function<Status(const ByteSink&)>;

/// Temporary files that a killed writer may leave behind begin with this; they are never read.
inline constexpr std::string_view kTemporaryPrefix = ".dubsar-tmp-";

/// Replaces `path` by the bytes, or leaves it as it was: writes a temporary file beside it, syncs it, renames
/// it and syncs the folder. Who may read the file that was there may read the new one, nobody else. After
/// success the file survives a power loss. On failure (ErrorKind::kStorage) no
/// temporary file stays behind. A device or pipe at `path` is written to directly; kUsage: nobody reads it.
[[nodiscard]] Status write_file_atomically(const std::filesystem::path& path,
                                           std::span<const std::byte> bytes);
[[nodiscard]] Status write_file_atomically(const std::filesystem::path& path, std::string_view text);
[[nodiscard]] Status write_file_atomically(const std::filesystem::path& path, const ByteProducer& produce);

/// The same, but where the name is a link to a file, that one is replaced and the link stays: of what people
/// keep elsewhere, and share.
[[nodiscard]] Status write_behind_link(const std::filesystem::path& path, std::string_view text);

/// The folder that a file lies in: "." for a name alone.
[[nodiscard]] std::filesystem::path folder_of(const std::filesystem::path& file);

/// Names that were made, renamed or removed in the folder survive a power loss after this, where the file
/// system can sync a folder at all: some network file systems cannot. Errors: kStorage.
[[nodiscard]] Status sync_folder(const std::filesystem::path& folder);

/// Files above this are refused by read_whole_file() unless a caller says otherwise.
inline constexpr std::uint64_t kMaxFileBytes = std::uint64_t{8} << 30U;

/// The bytes of a regular file, read once (not mapped: a file that shrinks meanwhile must not kill the
/// program). Errors: missing, unreadable, a folder, larger than `limit_bytes`.
[[nodiscard]] Result<std::string> read_whole_file(const std::filesystem::path& path,
                                                  std::uint64_t limit_bytes = kMaxFileBytes);
/// A stored file, to be read in pieces. What is no file is refused and not opened: a pipe would keep the
/// reader waiting, a device give bytes without an end. Errors: kBadInput.
[[nodiscard]] Result<std::ifstream> open_stored_file(const std::filesystem::path& path);
/// The first bytes of a file, at most `count`.
[[nodiscard]] Result<std::string> read_file_head(const std::filesystem::path& path, std::size_t count);

}  // namespace dubsar
