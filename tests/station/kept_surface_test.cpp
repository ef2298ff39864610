// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a session keeps of one surface: what is made anew of it, and what stays.

#include "station/kept_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/atomic_file.h"
#include "formats/mesh_io.h"
#include "station/selected_mesh.h"
#include "tests/support/raster_mesh.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

TEST(KeptSurface, ALostDrawingIsOfTheWedgesAsTheyAre) {
  const test::TemporaryFolder folder;
  SessionStore store = SessionStore::open_or_create(folder.path() / "s").value();
  Mesh mesh;
  for (int v = 0; v < 4; ++v) {
    mesh.positions.emplace_back(static_cast<float>(v % 2), static_cast<float>(v / 2), 0.0F);
  }
  test::add_raster_faces(mesh, 0, 1);
  ASSERT_TRUE(write_mesh(store.folder() / kSessionMesh, mesh));
  // Nobody could measure this one on that mesh.
  WedgeFile file;
  file.mesh = "../mesh/model.ply";
  file.text_from_model = RigidTransform();
  Wedge& wedge = file.wedges.emplace_back();
  wedge.id = 41;
  wedge.place.side = Face::kObverse;
  ASSERT_TRUE(
      store.replace_file("analysis/wedges.json", [&](const auto& to) { return write_wedges(to, file); }));
  const auto put = [](const auto& to) { return write_file_atomically(to, std::string_view("as it was")); };
  ASSERT_TRUE(store.replace_file("analysis/reverse.svg", put));
  const auto bytes = [&](const char* name) { return read_whole_file(store.folder() / name).value(); };
  const std::string wedges = bytes("analysis/wedges.json");
  JobContext job;
  const Status made = make_wedges_anew(store, {"analysis/obverse.svg"}, job);
  ASSERT_TRUE(made) << made.error().line();
  EXPECT_THAT(bytes("analysis/obverse.svg"), ::testing::HasSubstr("41"));
  EXPECT_EQ(bytes("analysis/reverse.svg"), "as it was");
  EXPECT_EQ(bytes("analysis/wedges.json"), wedges);
  EXPECT_THAT(store.verify(job).value().whole, ::testing::Contains("analysis/obverse.svg"));
}

}  // namespace
}  // namespace dubsar
