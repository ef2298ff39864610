// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A session folder in which one file is not what was stored. The first byte says which: the database, its
// log, its backup, the list of checksums or a grid. Opening for reading and for writing, verifying and
// mending must come to an end, and the scan that was not touched must be there.
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "acquisition/session_log.h"
#include "acquisition/session_store.h"
#include "core/job.h"
#include "formats/grid_file.h"
#include "fuzz/fuzz_support.h"

namespace fs = std::filesystem;
using namespace dubsar;

namespace {

RangeGrid small_grid(int number) {
  RangeGrid grid;
  grid.allocate(3, 4);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.valid[i] = 1;
    grid.x[i] = static_cast<float>(i + static_cast<std::size_t>(number));
  }
  grid.spacing_mm = 0.1;
  return grid;
}

struct Folders {
  fs::path all = fuzz::work_path();
  fs::path good = all / "good";
  Folders() {
    fs::remove_all(all);
    fs::create_directories(all);
    auto store = SessionStore::open_or_create(good);
    fuzz::require(store && store->add_grid(small_grid(0)) && store->add_grid(small_grid(1)) &&
                  store->save_document("rig", "{}") && store->save_flags(0, SampleFlags(12, kSparse)));
    std::ofstream(good / "mesh/model.ply") << "ply";
    fuzz::require(store->record_file("mesh/model.ply").has_value());
  }
  ~Folders() {
    std::error_code ignored;
    fs::remove_all(all, ignored);
  }
};

constexpr const char* kFiles[] = {"session.sqlite", "session.sqlite-wal", "session.backup.sqlite",
                                  "session.sums", "grids/001.grid"};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folders folders;
  if (size == 0) {
    return 0;
  }
  const fs::path folder = folders.all / "tried";
  fs::remove_all(folder);
  fs::copy(folders.good, folder, fs::copy_options::recursive);
  const std::string name = kFiles[data[0] % std::size(kFiles)];
  std::ofstream(folder / name, std::ios::binary)
      .write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
  // A database that is whole and says other things of this scan is believed.
  const bool another_database = name == kFiles[0];
  (void)session::read_log(folder / "session.sqlite-wal");
  JobContext job;
  VerifyReport report;
  if (const auto store = SessionStore::open(folder, SessionStore::Access::kReadOnly)) {
    if (auto found = store->verify(job)) {
      report = std::move(*found);
    }
    fuzz::require(another_database || store->load_grid(0));
  }
  if (auto store = SessionStore::open(folder)) {
    fuzz::require(another_database || store->load_grid(0));
    (void)store->repair(report, folders.good, job);
  }
  return 0;
}
