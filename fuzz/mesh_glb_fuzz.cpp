// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/mesh_io.h"
#include "fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (const auto mesh = dubsar::read_mesh_bytes(dubsar::fuzz::text_of(data, size), "mesh.glb")) {
    dubsar::fuzz::check_mesh(*mesh);
  }
  return 0;
}
