// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar-flips: turns over one bit of a byte at a time in a session that is closed, in one whose program was
// killed, and in a bag, and counts those that `dubsar verify` passes all the same.
//   dubsar-flips --per-file 2000 --seed 1
// Status 1 when one passed that is not in the last commit of a log, which no program can tell from a torn
// one.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "acquisition/session_log.h"
#include "acquisition/session_store.h"
#include "bench/support/options.h"
#include "formats/self_checked.h"
#include "tests/station/support/byte_flips.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;

void need(bool holds, const char* what) {
  if (!holds) {
    std::fprintf(stderr, "dubsar-flips: %s\n", what);
    std::exit(4);
  }
}

void command(const test::Arguments& arguments, bool may_fall_short) {
  const test::Outcome outcome = test::run_command(arguments, {.timeout_s = 600});
  need(outcome.status == 0 || (may_fall_short && outcome.status == 1), outcome.err.c_str());
}

/// Scanned, looked over by a person, signed.
void lay_out_session(const fs::path& folder) {
  command({"scan", "--auto", "--max-scans", "2", "-q", "--device", "sim:?seed=4&size=12x10x8&spacing=0.5",
           "--session", folder.string()},
          true);
  std::ofstream(folder / "analysis/selections.json")
      << with_own_checksum(R"({"mesh":"model.ply","vertices":9,"faces":3,"selections":[]})");
  std::ofstream(folder / "analysis/wedges.corrections.json")
      << with_own_checksum(R"({"unit":"mm","mesh":"model.ply","corrections":[]})");
  command({"session", "sign", folder.string(), "--name", "A. Conservator", "--incomplete", "a trial", "-q"},
          true);
}

/// What a program that is killed leaves: its last changes stand in the log alone.
void lay_out_killed(const fs::path& session, const fs::path& killed) {
  const fs::path open = killed.string() + "-open";
  fs::copy(session, open, fs::copy_options::recursive);
  auto store = SessionStore::open(open);
  need(store && store->save_document("note", R"({"text":"one"})") &&
           store->save_document("note", R"({"text":"two"})") && store->save_document("note", "{}"),
       "the session cannot be written on");
  fs::copy(open, killed, fs::copy_options::recursive);
}

/// Where the last commit of a log begins; what stands behind it belongs to it.
std::uintmax_t last_commit(const fs::path& log) {
  constexpr std::uintmax_t kHeader = 32;  // of the file; a frame has a header of 24 bytes, then its page
  std::uintmax_t begins = kHeader;
  const std::uintmax_t bytes = fs::file_size(log);
  std::ifstream file(log, std::ios::binary);
  const auto word = [&](std::uintmax_t at) {
    unsigned char b[4] = {};
    file.seekg(static_cast<std::streamoff>(at));
    file.read(reinterpret_cast<char*>(b), 4);
    return std::uintmax_t{b[0]} << 24U | std::uintmax_t{b[1]} << 16U | std::uintmax_t{b[2]} << 8U | b[3];
  };
  const std::uintmax_t frame = 24 + word(8);
  for (std::uintmax_t at = kHeader; at + frame < bytes; at += frame) {
    begins = word(at + 4) != 0 ? at + frame : begins;  // a commit ends here
  }
  return begins;
}

/// Prints a row for each file; returns how many passed that should not have.
int report(const char* what, const fs::path& folder, std::uintmax_t per_file, Random& random) {
  need(test::passes_verification(folder), "what is whole is not passed");
  std::uintmax_t files = 0;
  test::FlipTally all;
  int missed = 0;
  int torn = 0;
  for (const auto& [name, tally] : test::flip_bytes(folder, per_file, random)) {
    ++files;
    all.bytes += tally.bytes;
    all.tried += tally.tried;
    all.idle += tally.idle;
    const std::uintmax_t end = name.ends_with("-wal") ? last_commit(folder / name) : tally.bytes;
    for (const std::uintmax_t at : tally.missed) {
      if (at >= end) {
        ++torn;
        continue;
      }
      ++missed;
      std::fprintf(stderr, "%s: %s: byte %ju of %ju passes\n", what, name.c_str(), at, tally.bytes);
    }
  }
  need(test::passes_verification(folder), "the folder is not as it was");
  std::printf("| %s | %ju | %ju | %ju | %ju | %d | %d |\n", what, files, all.bytes, all.tried, all.idle, torn,
              missed);
  std::fflush(stdout);
  return missed;
}

int run(int argc, char** argv) {
  CLI::App app("Damages a session and a bag, byte by byte, and counts what verification does not notice");
  std::uintmax_t per_file = 2000;
  std::uint64_t seed = 1;
  app.add_option("--per-file", per_file, "bytes tried of each file")->check(CLI::Range(1, 1 << 30));
  app.add_option("--seed", seed);
  if (const auto status = dubsar::bench::ends_with(app, argc, argv)) {
    return *status;
  }

  const test::TemporaryFolder folder;
  const fs::path session = folder.path() / "session";
  const fs::path killed = folder.path() / "killed";
  const fs::path bag = folder.path() / "bag";
  lay_out_session(session);
  lay_out_killed(session, killed);
  command({"export", session.string(), "--to", bag.string(), "--without", "renderings", "-q"}, false);
  Random random(seed);
  std::printf(
      "| what | files | bytes | tried | passed, all reads as before | passed, in the last commit of a log | "
      "passed |\n");
  std::printf("|---|---|---|---|---|---|---|\n");
  const int missed = report("session", session, per_file, random) +
                     report("session, its program killed", killed, per_file, random) +
                     report("bag", bag, per_file, random);
  return missed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace dubsar

int main(int argc, char** argv) {
  return dubsar::run(argc, argv);
}
