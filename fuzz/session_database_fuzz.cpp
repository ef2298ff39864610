// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The database of a session alone: found whole or damaged, and what can be saved of its rows, without the
// session around it, so that it runs ten times as often as in the target `session`. After a first byte 's'
// the rows get checksums that fit, or hardly any that was changed would be looked at.
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "acquisition/session_tables.h"
#include "acquisition/sqlite_db.h"
#include "fuzz/fuzz_support.h"

namespace fs = std::filesystem;
using namespace dubsar;

namespace {

/// SQLite reads files only. The two databases beside it are kept: to make their tables took longer than all
/// that is tried.
struct Databases {
  fs::path path = fuzz::work_path();
  SqlDatabase memory = open_memory("memory");
  SqlDatabase saved = open_memory("saved");
  Databases() { fuzz::require(session::prepare_schema(saved, "saved").has_value()); }
  ~Databases() {
    std::error_code ignored;
    fs::remove(path, ignored);
  }
  static SqlDatabase open_memory(const char* name) {
    auto opened = SqlDatabase::open(name, SqlDatabase::Mode::kMemory);
    fuzz::require(opened.has_value());
    return std::move(*opened);
  }
};

void try_to_save(SqlDatabase& from, SqlDatabase& saved) {
  const auto taken_back = SqlTransaction::begin(saved);
  fuzz::require(taken_back.has_value());
  // What is saved is whole, and all that is counted as saved is there.
  const std::int64_t count = session::salvage_rows(from, saved, true);
  const auto damaged = session::damaged_rows(saved);
  fuzz::require(count >= 0 && damaged && damaged->empty() && saved.structure_fault().empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Databases databases;
  if (size == 0) {
    return 0;
  }
  std::ofstream(databases.path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
  auto from = SqlDatabase::open(databases.path, SqlDatabase::Mode::kImmutable);
  if (!from) {
    return 0;
  }
  SqlDatabase& memory = databases.memory;
  SqlDatabase* rows = &*from;
  if (memory.copy_from(*from)) {
    if (data[0] == 's') {
      for (const session::Table& table : session::kTables) {
        const std::string fit =
            std::string("UPDATE ") + table.name + " SET sum = dubsar_sum(" + table.columns + ")";
        (void)memory.execute(fit.c_str());
      }
      rows = &memory;
    }
    if (session::prepare_schema(memory, "memory") && memory.structure_fault().empty()) {
      (void)session::damaged_rows(memory);
    }
  }
  try_to_save(*rows, databases.saved);
  return 0;
}
