// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What each vertex of one body reads does not depend on what else lies in the mesh.

#include "analysis/body_fields.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <fstream>

#include "analysis/mesh_bodies.h"
#include "analysis/outlook.h"
#include "tests/analysis/support/shapes.h"

namespace dubsar {
namespace {

const Eigen::Vector3f kHalfMm(2, 1.6F, 0.8F);

Mesh tablet(const Eigen::Vector3f& at) {
  Mesh mesh = shapes::box(kHalfMm, 72);
  for (Eigen::Vector3f& p : mesh.positions) {
    p += at;
  }
  return mesh;
}

Mesh together(const Mesh& one, const Mesh& other) {
  Mesh both = one;
  const auto first = static_cast<std::uint32_t>(one.positions.size());
  both.positions.insert(both.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& [a, b, c] : other.faces) {
    both.faces.push_back({a + first, b + first, c + first});
  }
  return both;
}

struct Fields {
  std::size_t bodies = 0;
  std::vector<float> openness;
  IntegralInvariants invariants;
};

Fields fields_of(const Mesh& mesh) {
  const JobContext job;
  const VertexGeometry geometry = make_vertex_geometry(mesh, make_vertex_graph(mesh));
  const MeshBodies bodies = find_bodies(mesh, geometry);
  const std::vector<Eigen::Vector3f> outlook =
      of_each_body(mesh, bodies.of, [](const Mesh& body) { return mean_outlook(body, 1.0); });
  return {bodies.count, openness_of_bodies(mesh, geometry, {}, job),
          invariants_of_bodies(mesh, bodies.of, outlook, geometry.mean_edge_mm, {}, job)};
}

TEST(BodyFields, OfTwoBodiesSideBySideAreThoseOfEachAlone) {
  const Mesh one = tablet({0, 0, 0});
  const Mesh other = tablet({5.5F, 0.4F, -0.4F});
  const Fields first = fields_of(one);
  const Fields second = fields_of(other);
  const Fields both = fields_of(together(one, other));
  ASSERT_EQ(both.bodies, 2U);
  ASSERT_EQ(both.openness.size(), first.openness.size() + second.openness.size());
  ASSERT_EQ(both.invariants.value.size(), first.invariants.value.size() + second.invariants.value.size());
  for (std::size_t v = 0; v < both.openness.size(); ++v) {
    const std::size_t of_second = v - std::min(v, first.openness.size());
    const float alone = v < first.openness.size() ? first.openness[v] : second.openness[of_second];
    ASSERT_NEAR(both.openness[v], alone, 1e-6) << v;
  }
  for (std::size_t k = 0; k < both.invariants.value.size(); ++k) {
    const std::size_t of_second = k - std::min(k, first.invariants.value.size());
    const float alone =
        k < first.invariants.value.size() ? first.invariants.value[k] : second.invariants.value[of_second];
    ASSERT_NEAR(both.invariants.value[k], alone, 1e-6) << k;
  }
  // Of the whole radius: of the smallest an edge of no roundness is what the map's pixels make of it.
  for (std::size_t k = 0; k < both.invariants.value.size(); k += both.invariants.radii_mm.size()) {
    ASSERT_LT(both.invariants.value[k], 0.1F) << "no valley is on a box: " << k;
  }
}

/// So much more than the process has now; put back at the end.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::uint64_t more_bytes) {
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    ::getrlimit(RLIMIT_AS, &before_);
    const rlimit now{pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) + more_bytes,
                     before_.rlim_max};
    ::setrlimit(RLIMIT_AS, &now);
  }
  ~MemoryLimit() { ::setrlimit(RLIMIT_AS, &before_); }
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  rlimit before_{};
};

TEST(BodyFields, AScrapFarOffTakesNoMemoryAndChangesNothing) {
  const Mesh one = tablet({0, 0, 0});
  const Mesh two = together(one, tablet({5.5F, 0.4F, -0.4F}));
  Mesh scrap;
  scrap.positions = {{5000, 5000, 5000}, {5000.2F, 5000, 5000}, {5000, 5000.2F, 5000}};
  scrap.faces = {{0, 1, 2}};
  const MemoryLimit limit(std::uint64_t{4} << 30U);  // a map that reaches there has 25 GB
  for (const Mesh& mesh : {one, two}) {
    const Fields alone = fields_of(mesh);
    Fields beside = fields_of(together(mesh, scrap));
    ASSERT_EQ(beside.bodies, alone.bodies);
    const std::size_t values = alone.invariants.value.size();
    ASSERT_EQ(beside.invariants.value.size(), values + 3 * alone.invariants.radii_mm.size());
    for (std::size_t k = 0; k < beside.invariants.value.size(); ++k) {
      ASSERT_NEAR(beside.invariants.value[k], k < values ? alone.invariants.value[k] : 0, 1e-5) << k;
    }
  }
}

}  // namespace
}  // namespace dubsar
