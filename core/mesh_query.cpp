// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/mesh_query.h"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/lasting_thread.h"

namespace dubsar {

namespace {

/// Embree keeps an allocator (192 bytes) for every thread that has ever built a tree, until the program ends.
/// The threads of a scan end with it: those few bytes would hold on to a page of memory each.
LastingThread& tree_builder() {
  static LastingThread thread;
  return thread;
}

}  // namespace

struct MeshQuery::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<Eigen::Vector3f> positions;
  std::vector<std::array<std::uint32_t, 3>> faces;

  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (scene != nullptr) {
      rtcReleaseScene(scene);
    }
    if (device != nullptr) {
      rtcReleaseDevice(device);
    }
  }
};

MeshQuery::MeshQuery(const Mesh& mesh) : impl_(std::make_unique<Impl>()) {
  impl_->device = rtcNewDevice(nullptr);
  if (impl_->device == nullptr) {
    throw std::runtime_error("Embree gave no device");
  }
  // Embree reads 16 bytes at the last vertex; one spare keeps that inside the array.
  impl_->positions.reserve(mesh.positions.size() + 1);
  impl_->positions = mesh.positions;
  impl_->positions.emplace_back(Eigen::Vector3f::Zero());
  impl_->faces = mesh.faces;
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, impl_->positions.data(),
                             0, sizeof(Eigen::Vector3f), mesh.positions.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, impl_->faces.data(), 0,
                             3 * sizeof(std::uint32_t), impl_->faces.size());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(impl_->scene, geometry);
  rtcReleaseGeometry(geometry);
  tree_builder().run([scene = impl_->scene] { rtcCommitScene(scene); });
}

MeshQuery::~MeshQuery() = default;
MeshQuery::MeshQuery(MeshQuery&&) noexcept = default;
MeshQuery& MeshQuery::operator=(MeshQuery&&) noexcept = default;

namespace {

RTCRay make_ray(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near_mm,
                float far_mm) {
  RTCRay ray{};
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.tnear = near_mm;
  ray.tfar = far_mm;
  ray.mask = std::numeric_limits<unsigned>::max();
  return ray;
}

/// Closest point on triangle abc to p, after Ericson, Real-Time Collision Detection, 5.1.5.
Eigen::Vector3f closest_on_triangle(const Eigen::Vector3f& p, const Eigen::Vector3f& a,
                                    const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
  const Eigen::Vector3f ab = b - a;
  const Eigen::Vector3f ac = c - a;
  const Eigen::Vector3f ap = p - a;
  const float d1 = ab.dot(ap);
  const float d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) {
    return a;
  }
  const Eigen::Vector3f bp = p - b;
  const float d3 = ab.dot(bp);
  const float d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) {
    return b;
  }
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    return a + ab * (d1 / (d1 - d3));
  }
  const Eigen::Vector3f cp = p - c;
  const float d5 = ab.dot(cp);
  const float d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) {
    return c;
  }
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    return a + ac * (d2 / (d2 - d6));
  }
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && (d4 - d3) >= 0 && (d5 - d6) >= 0) {
    return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  }
  const float sum = va + vb + vc;
  if (sum <= 0) {
    return a;  // no area: any corner is as good
  }
  return a + ab * (vb / sum) + ac * (vc / sum);
}

struct ClosestSearch {
  const std::vector<Eigen::Vector3f>* positions;
  const std::vector<std::array<std::uint32_t, 3>>* faces;
  Eigen::Vector3f query;
  ClosestPoint best;
  bool found = false;
};

bool visit_closest(RTCPointQueryFunctionArguments* args) {
  auto& search = *static_cast<ClosestSearch*>(args->userPtr);
  const auto& f = (*search.faces)[args->primID];
  const Eigen::Vector3f q = closest_on_triangle(search.query, (*search.positions)[f[0]],
                                                (*search.positions)[f[1]], (*search.positions)[f[2]]);
  const float d = (q - search.query).norm();
  const bool nearer = d < args->query->radius;
  const bool tie = search.found && d == args->query->radius && args->primID < search.best.face;
  if (nearer || tie) {
    search.best = {q, d, args->primID};
    search.found = true;
    args->query->radius = d;
    return true;
  }
  return false;
}

}  // namespace

std::optional<RayHit> MeshQuery::first_hit(const Eigen::Vector3f& origin_mm, const Eigen::Vector3f& direction,
                                           float near_mm, float far_mm) const {
  RTCRayHit hit{};
  hit.ray = make_ray(origin_mm, direction, near_mm, far_mm);
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->scene, &context, &hit);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
    return std::nullopt;
  }
  const Eigen::Vector3f n(hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z);
  return RayHit{hit.ray.tfar, hit.hit.primID, n.normalized(), hit.hit.u, hit.hit.v};
}

bool MeshQuery::occluded(const Eigen::Vector3f& a_mm, const Eigen::Vector3f& b_mm, float margin_mm) const {
  const Eigen::Vector3f ab = b_mm - a_mm;
  const float length = ab.norm();
  if (length <= 2 * margin_mm) {
    return false;
  }
  RTCRay ray = make_ray(a_mm, ab / length, margin_mm, length - margin_mm);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(impl_->scene, &context, &ray);
  return ray.tfar < 0;
}

std::optional<ClosestPoint> MeshQuery::closest(const Eigen::Vector3f& p_mm, float radius_mm) const {
  ClosestSearch search{&impl_->positions, &impl_->faces, p_mm, {}, false};
  RTCPointQuery query{};
  query.x = p_mm.x();
  query.y = p_mm.y();
  query.z = p_mm.z();
  query.radius = radius_mm;
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(impl_->scene, &query, &context, visit_closest, &search);
  if (!search.found) {
    return std::nullopt;
  }
  return search.best;
}

}  // namespace dubsar
