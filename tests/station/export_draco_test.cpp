// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar export --draco: the compressed model beside the plain one, told of wherever that one is.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "formats/mesh_io.h"
#include "tests/station/support/exported.h"
#include "tests/station/support/shell.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using test::files_below;
using test::Outcome;
using test::run_command;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(Export, TheModelIsCompressedWhereThatIsAskedFor) {
  ASSERT_EQ(whole_.status, 0) << whole_.err;
  EXPECT_THAT(files_below(at("bag")), Not(Contains(HasSubstr("draco"))));
  const Outcome done = export_to("sent", {"--draco", "--without", "features,grid-ply,wedges"});
  ASSERT_EQ(done.status, 0) << done.err;
  const fs::path payload = at("sent") / "data";
  const auto files = files_below(payload);
  for (const char* file : {"model/session.ply", "model/session.glb", "model/session.stl"}) {
    EXPECT_THAT(files, Contains(file)) << "is there as always";
  }
  ASSERT_THAT(files, Contains("model/session.draco.glb"));
  EXPECT_THAT(bytes_of(at("sent") / "manifest-sha512.txt"), HasSubstr("  data/model/session.draco.glb\n"));
  EXPECT_EQ(run_command({"verify", at("sent").string()}).status, 0);

  const std::string readme = bytes_of(payload / "README.txt");
  EXPECT_THAT(readme, HasSubstr("  model/session.draco.glb\n"));
  EXPECT_THAT(readme, HasSubstr("0.0153 micrometres"));
  const nlohmann::json manifest = nlohmann::json::parse(bytes_of(payload / "iiif/manifest.json"));
  const auto& rendering = manifest["rendering"];
  const auto link = std::ranges::find_if(rendering, [](const nlohmann::json& one) {
    return one["id"].get<std::string>().ends_with("/model/session.draco.glb");
  });
  ASSERT_NE(link, rendering.end());
  EXPECT_EQ((*link)["format"], "model/gltf-binary");
  EXPECT_THAT(rendering[0]["id"].get<std::string>(), HasSubstr("/model/session.glb"))
      << "the plain one first";
  const std::string provenance = bytes_of(payload / "provenance.jsonld");
  EXPECT_THAT(provenance, HasSubstr("/model/session.draco.glb"));
  EXPECT_THAT(provenance, HasSubstr("step of the positions in the compressed form"));

  EXPECT_LT(4 * fs::file_size(payload / "model/session.draco.glb"),
            fs::file_size(payload / "model/session.glb"));
  const auto packed = read_mesh(payload / "model/session.draco.glb");
  const auto plain = read_mesh(payload / "model/session.glb");
  ASSERT_TRUE(packed && plain);
  EXPECT_EQ(packed->faces.size(), plain->faces.size());
  EXPECT_EQ(packed->positions.size(), plain->positions.size());
}

TEST_F(Export, WithTheCompressedModelItIsAnotherPackage) {
  const std::vector<std::string> small{"--without", "renderings,features,grid-ply,wedges"};
  std::vector<std::string> packed = small;
  packed.emplace_back("--draco");
  ASSERT_EQ(export_to("compressed", packed).status, 0);
  EXPECT_EQ(export_to("compressed", packed).json().value("done_before", false), true);
  const Outcome other = export_to("compressed", small);
  EXPECT_EQ(other.status, 2) << other.err;
  EXPECT_THAT(other.out + other.err, HasSubstr("something lies there already"));
}

TEST_F(Export, MeshesAreCompressedByTheirName) {
  const fs::path mesh = at("by_name.draco.glb");
  ASSERT_EQ(run_command({"mesh", "convert", data("model/session.ply").string(), mesh.string()}).status, 0);
  EXPECT_LT(4 * fs::file_size(mesh), fs::file_size(data("model/session.glb")));
  EXPECT_EQ(run_command({"mesh", "check", mesh.string()}).status, 0) << "still a 2-manifold";
}

}  // namespace
}  // namespace dubsar
