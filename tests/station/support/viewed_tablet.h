// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "core/mesh.h"
#include "formats/corrections_json.h"
#include "formats/mesh_io.h"
#include "sim/tablet.h"
#include "station/analysis.h"
#include "station/mesh_viewing.h"
#include "tests/support/temporary_folder.h"

namespace dubsar::test {

inline void settle(const MeshViewing& viewing) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (!viewing.state().stage.empty() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

/// A mesh that is looked at, and waited for.
class Viewer {
 public:
  explicit Viewer(const std::filesystem::path& mesh) : viewing_([] {}) { open(mesh); }
  void open(const std::filesystem::path& mesh) {
    viewing_.open(mesh);
    settle();
  }
  void remove_wedge(const Eigen::Vector3d& at_mm) {
    WedgeCorrection gone;
    gone.at_mm = {at_mm};
    viewing_.correct(gone);
    settle();
  }
  void find_wedges() {
    viewing_.analyse();
    settle();
  }
  void undo() {
    viewing_.undo_correction();
    settle();
  }
  void keep(const std::string& name) {
    viewing_.keep_selection({name, MeshElement::kFace, {{0, 3}}});
    settle();
  }
  [[nodiscard]] ViewedMesh state() const { return viewing_.state(); }

 private:
  void settle() const { test::settle(viewing_); }
  MeshViewing viewing_;
};

/// A small written tablet lies there as a mesh, and where its wedges are is known.
class OnAViewedTablet : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    sim::TabletOptions options;
    options.seed = 5;
    options.size_mm = {14, 11, 8};
    options.spacing_mm = 0.2;
    JobContext job;
    tablet_ = new Mesh(sim::make_tablet(options, job)->mesh);
    const Result<Analysis> analysis = analyze_mesh(*tablet_, {}, job);
    ASSERT_TRUE(analysis);
    wedges_mm_.clear();  // of a suite before
    for (const Wedge& wedge : analysis->set.wedges) {
      wedges_mm_.push_back(wedge.depth_point_mm);
    }
    ASSERT_GT(wedges_mm_.size(), 1U);
  }
  static void TearDownTestSuite() { delete tablet_; }
  void SetUp() override {
    std::filesystem::create_directories(mesh_.parent_path());
    ASSERT_TRUE(write_mesh(mesh_, *tablet_));
  }
  [[nodiscard]] std::size_t noted() const { return read_corrections(corrections_)->corrections.size(); }

  inline static Mesh* tablet_ = nullptr;
  inline static std::vector<Eigen::Vector3d> wedges_mm_;
  TemporaryFolder folder_;
  std::filesystem::path mesh_ = folder_.path() / "mesh" / "tablet.ply";
  std::filesystem::path corrections_ = folder_.path() / "mesh" / "tablet.wedges.corrections.json";
};

}  // namespace dubsar::test
