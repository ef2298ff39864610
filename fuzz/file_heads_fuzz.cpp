// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is told from the first bytes of a file before, or without, reading it: whose mesh it says it is, its
// unit, whether it is a scan, how many scans a PTX holds.
#include "formats/file_label_reader.h"
#include "formats/grid_reader.h"
#include "formats/ply_header.h"
#include "formats/states_ply.h"
#include "formats/text_scans.h"
#include "fuzz/fuzz_support.h"

using namespace dubsar;

namespace {

/// As a mesh of it would say it.
FileLabel written_again(const FileLabel& label) {
  return file_label_in(mesh_line(label, "# ") + label_lines(label, "# "));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view head = fuzz::text_of(data, size);
  const FileLabel label = written_again(file_label_in(head));
  fuzz::require(written_again(label).words == label.words);
  (void)label_in_ascii(label, 80);
  fuzz::require(!states_unit(head, "head") || is_ply(head));
  (void)is_states_ply(head);
  for (const char* name : {"a.ply", "a.grid", "a.ptx", "a.xyz", "a.txt", "a.conf", "a"}) {
    for (const bool whole : {false, true}) {
      (void)kind_of_head(head, whole, name);
    }
  }
  if (const auto scans = read_ptx(head, "a.ptx", {})) {
    const auto count = count_ptx_scans(head, "a.ptx");
    fuzz::require(count && static_cast<std::size_t>(*count) == scans->size());
  }
  return 0;
}
