// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The database of a session alone: found whole or damaged, and what can be saved of its rows, without the
// session around it, so that it runs ten times as often as in the target `session`. After a first byte 's'
// the rows get checksums that fit, or hardly any that was changed would be looked at.
#include <filesystem>
#include <fstream>
#include <string>

#include "acquisition/session_tables.h"
#include "acquisition/sqlite_db.h"
#include "fuzz/fuzz_support.h"

namespace fs = std::filesystem;
using namespace dubsar;

namespace {

/// SQLite reads files only.
struct File {
  fs::path path = fuzz::work_path();
  ~File() {
    std::error_code ignored;
    fs::remove(path, ignored);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const File file;
  if (size == 0) {
    return 0;
  }
  std::ofstream(file.path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
  auto from = SqlDatabase::open(file.path, SqlDatabase::Mode::kImmutable);
  auto memory = SqlDatabase::open("memory", SqlDatabase::Mode::kMemory);
  auto saved = SqlDatabase::open("saved", SqlDatabase::Mode::kMemory);
  fuzz::require(memory && saved && session::prepare_schema(*saved, "saved"));
  if (!from) {
    return 0;
  }
  SqlDatabase* rows = &*from;
  if (memory->copy_from(*from)) {
    if (data[0] == 's') {
      for (const session::Table& table : session::kTables) {
        const std::string fit =
            std::string("UPDATE ") + table.name + " SET sum = dubsar_sum(" + table.columns + ")";
        (void)memory->execute(fit.c_str());
      }
      rows = &*memory;
    }
    if (session::prepare_schema(*memory, "memory") && memory->structure_fault().empty()) {
      (void)session::damaged_rows(*memory);
    }
  }
  // What is saved is whole, and all that is counted as saved is there.
  const std::int64_t count = session::salvage_rows(*rows, *saved, true);
  const auto damaged = session::damaged_rows(*saved);
  fuzz::require(count >= 0 && damaged && damaged->empty() && saved->structure_fault().empty());
  return 0;
}
