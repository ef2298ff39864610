// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/file_label_reader.h"
#include "formats/mesh_io.h"
#include "fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (const auto mesh = dubsar::read_mesh_bytes(dubsar::fuzz::text_of(data, size), "mesh.ply")) {
    dubsar::fuzz::check_mesh(*mesh);
  }
  const dubsar::FileLabel label = dubsar::file_label_in(dubsar::fuzz::text_of(data, size));
  (void)dubsar::label_lines(label, "comment ");
  return 0;
}
