// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/tablet_frame.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "core/parallel.h"

namespace dubsar {

namespace {

// Of the second moment, as shares of its trace: a cube has three thirds, a thin plate 1, 0, 0. A tablet of
// 50 × 40 × 20 mm has 0.53.
constexpr double kSlabLead = 0.08;       ///< by which the largest must exceed the second
constexpr double kStraightEdges = 0.15;  ///< of the fourfold moment: 1 for a box, 0 for a disc
constexpr double kEdgeNormalZ = 0.6;     ///< steeper than this belongs to the edges

bool is_usable(const SurfaceElement& e) {
  return e.position_mm.allFinite() && e.area_normal.allFinite() && e.area_normal.squaredNorm() > 0;
}

/// `count` elements; element(i) -> SurfaceElement makes each when it is looked at, for a surface of tens of
/// millions of them is looked at three times faster than it is kept.
template <class Element>
struct Surface {
  std::size_t count;
  Element element;

  /// add(T& to, const SurfaceElement&) over all usable ones, summed up in the same order for any number of
  /// threads.
  template <class T, class Add, class Join>
  T reduce(const T& nothing, const Add& add, const Join& join) const {
    return parallel_reduce_ordered(
        count, std::size_t{1} << 16U, nothing,
        [&](std::size_t begin, std::size_t end) {
          T sum = nothing;
          for (std::size_t i = begin; i < end; ++i) {
            if (const SurfaceElement e = element(i); is_usable(e)) {
              add(sum, e);
            }
          }
          return sum;
        },
        join);
  }
};

template <class Element>
Surface(std::size_t, Element) -> Surface<Element>;

/// The axis across the slab, or nothing.
template <class Element>
Eigen::Vector3d slab_axis(const Surface<Element>& surface) {
  const Eigen::Matrix3d moment = surface.reduce(
      Eigen::Matrix3d(Eigen::Matrix3d::Zero()),
      [](Eigen::Matrix3d& sum, const SurfaceElement& e) {
        const Eigen::Vector3d n = e.area_normal.cast<double>();
        sum += n * n.transpose() / n.norm();
      },
      [](Eigen::Matrix3d& into, const Eigen::Matrix3d& part) { into += part; });
  const double trace = moment.trace();
  if (!(trace > 0) || !std::isfinite(trace)) {
    return Eigen::Vector3d::Zero();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moment / trace);
  if (solver.info() != Eigen::Success || solver.eigenvalues()[2] - solver.eigenvalues()[1] < kSlabLead) {
    return Eigen::Vector3d::Zero();
  }
  return solver.eigenvectors().col(2);
}

/// Angle of one pair of edges about z, from the plane's axis u, within a quarter turn; nothing when the
/// outline is too round.
template <class Element>
double edge_angle(const Surface<Element>& surface, const Eigen::Vector3d& u, const Eigen::Vector3d& v,
                  const Eigen::Vector3d& z) {
  struct Moment {
    std::complex<double> fourfold = 0;
    double weight = 0;
  };
  const Moment moment = surface.reduce(
      Moment(),
      [&](Moment& sum, const SurfaceElement& e) {
        const Eigen::Vector3d n = e.area_normal.cast<double>();
        const double area = n.norm();
        if (std::abs(n.dot(z)) < kEdgeNormalZ * area) {
          const std::complex<double> across(n.dot(u) / area, n.dot(v) / area);
          const double r = std::abs(across);
          const std::complex<double> twofold = (across / r) * (across / r);
          sum.fourfold += area * r * twofold * twofold;
          sum.weight += area * r;
        }
      },
      [](Moment& into, const Moment& part) {
        into.fourfold += part.fourfold;
        into.weight += part.weight;
      });
  return moment.weight > 0 && std::abs(moment.fourfold) > kStraightEdges * moment.weight
             ? std::arg(moment.fourfold) / 4
             : std::numeric_limits<double>::quiet_NaN();
}

template <class Element>
RigidTransform centred(const Surface<Element>& surface, const Eigen::Matrix3d& tablet_from_model) {
  using Box = Eigen::AlignedBox3d;
  const Box box = surface.reduce(
      Box(),
      [&](Box& sum, const SurfaceElement& e) {
        sum.extend(Eigen::Vector3d(tablet_from_model * e.position_mm.cast<double>()));
      },
      [](Box& into, const Box& part) { into.extend(part); });
  RigidTransform frame;
  frame.rotation = tablet_from_model;
  if (!box.isEmpty()) {
    frame.translation_mm = -0.5 * (box.min() + box.max());
  }
  return frame;
}

template <class Element>
RigidTransform frame_of(const Surface<Element>& surface) {
  Eigen::Vector3d z = slab_axis(surface);
  if (z.isZero()) {
    return centred(surface, Eigen::Matrix3d::Identity());
  }
  if (z.z() < 0) {
    z = -z;
  }
  // The model's x, or its y where x runs across the slab, as far as it lies in the slab.
  const bool x_lies_across = std::abs(z.x()) > 0.9;
  const Eigen::Vector3d hint = x_lies_across ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX();
  Eigen::Vector3d u = (hint - z * z.dot(hint)).normalized();
  Eigen::Vector3d v = z.cross(u);
  const double angle = edge_angle(surface, u, v, z);
  if (std::isfinite(angle)) {
    const Eigen::Vector3d turned = std::cos(angle) * u + std::sin(angle) * v;
    v = z.cross(turned);
    u = turned;
  }
  // Of the four quarter turns, the one whose axes agree best with the model's.
  Eigen::Matrix3d best;
  double best_agreement = -std::numeric_limits<double>::infinity();
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double agreement = u.x() + v.y();
    if (agreement > best_agreement + 1e-9) {
      best_agreement = agreement;
      best.row(0) = u;
      best.row(1) = v;
      best.row(2) = z;
    }
    const Eigen::Vector3d next = v;
    v = -u;
    u = next;
  }
  return centred(surface, best);
}

}  // namespace

RigidTransform tablet_frame(std::span<const SurfaceElement> surface) {
  return frame_of(Surface{surface.size(), [&](std::size_t i) { return surface[i]; }});
}

RigidTransform tablet_frame(const Mesh& mesh) {
  return frame_of(Surface{mesh.faces.size(), [&](std::size_t f) {
                            const auto& [a, b, c] = mesh.faces[f];
                            if (std::max({a, b, c}) >= mesh.positions.size()) {
                              return SurfaceElement();  // without area
                            }
                            const Eigen::Vector3f& p = mesh.positions[a];
                            const Eigen::Vector3f& q = mesh.positions[b];
                            const Eigen::Vector3f& r = mesh.positions[c];
                            return SurfaceElement{(p + q + r) / 3.0F, (q - p).cross(r - p) * 0.5F};
                          }});
}

}  // namespace dubsar
