// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a session is judged by beside its database: a log of SQLite, the list of checksums, and the checksum
// that a person's file carries. From memory, so that they run a thousand times as often as in the target
// `session`.
#include <algorithm>
#include <sstream>

#include "acquisition/session_files.h"
#include "acquisition/session_log.h"
#include "formats/self_checked.h"
#include "fuzz/fuzz_support.h"

using namespace dubsar;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of(data, size);
  const std::string rest(text.substr(std::min<std::size_t>(1, size)));
  switch (text.empty() ? '\0' : text.front()) {
    case 'l': {
      std::istringstream file(rest);
      const session::LogState log = session::read_log(file, rest.size());
      fuzz::require(log.commits >= 0 && log.commits <= log.frames && log.lost_commits >= 0);
      fuzz::require(static_cast<std::size_t>(log.frames) * (24 + 512) <= rest.size());
      break;
    }
    case 's': {
      // With the checksum that fits, or hardly anything would get past it.
      const auto sums =
          session::parse_sums(std::to_string(session::hash_of(rest)) + "\n" + rest, "session.sums");
      fuzz::require(sums.has_value());
      const auto again = session::parse_sums(session::text_of_sums(*sums), "again");
      fuzz::require(again && *again == *sums);
      (void)session::parse_sums(rest, "session.sums");
      break;
    }
    default:
      fuzz::require(own_checksum_of(rest) != OwnChecksum::kFails || !parse_self_checked(rest, "own"));
      if (rest.starts_with('{') && rest.size() > 1) {
        fuzz::require(own_checksum_of(with_own_checksum(rest)) == OwnChecksum::kFits);
      }
  }
  return 0;
}
