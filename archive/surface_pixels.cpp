// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/surface_pixels.h"

#include <algorithm>
#include <cmath>

#include "archive/colour.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

constexpr Rgb8 kClayTone{205, 176, 143};
constexpr Rgb8 kPaleClay{204, 194, 180};
constexpr Rgb8 kInside{58, 54, 56};
constexpr int kManyScans = 6;

/// The colour of a vertex in the chosen style.
class Paint {
 public:
  Paint(const Mesh& mesh, RenderStyle style, std::span<const float> tone)
      : mesh_(mesh), style_(style), tone_(tone) {
    const std::size_t count = mesh.positions.size();
    const bool has_values = (style == RenderStyle::kRedMap) ||
                            (style == RenderStyle::kReliability && mesh.reliability.size() == count) ||
                            (style == RenderStyle::kScanCount && mesh.scans.size() == count) ||
                            (style == RenderStyle::kColours && mesh.colours.size() == count) ||
                            (style == RenderStyle::kTone && tone.size() == count);
    if (!has_values) {
      style_ = RenderStyle::kClay;
    }
    has_flags_ = mesh.flags.size() == count;
  }

  [[nodiscard]] LinearRgb operator()(std::uint32_t v) const {
    switch (style_) {
      case RenderStyle::kClay:
        return clay_;
      case RenderStyle::kRedMap:
        return has_flags_ && (mesh_.flags[v] & kVertexInterpolated) != 0 ? amber_ : pale_;
      case RenderStyle::kReliability:
        return to_linear(lightness_ramp(mesh_.reliability[v]));
      case RenderStyle::kScanCount:
        return to_linear(lightness_ramp((mesh_.scans[v] - 1.0) / (kManyScans - 1.0)));
      case RenderStyle::kTone: {
        const auto grey = static_cast<std::uint8_t>(std::clamp(tone_[v], 0.0F, 1.0F) * 255.0F + 0.5F);
        return to_linear({grey, grey, grey});
      }
      case RenderStyle::kColours:
        break;
    }
    return to_linear(mesh_.colours[v]);
  }

 private:
  const Mesh& mesh_;
  RenderStyle style_;
  std::span<const float> tone_;
  bool has_flags_ = false;
  LinearRgb clay_ = to_linear(kClayTone);
  LinearRgb pale_ = to_linear(kPaleClay);
  LinearRgb amber_ = to_linear(kAmberOfExcused);
};

/// One subpixel's share of a pixel.
struct Shard {
  Eigen::Vector3f normal{0, 0, 1};
  LinearRgb colour{};
  bool plain = false;
};

/// Interpolates over one face; neighbouring subpixels mostly see the same face, so it is kept.
class FaceSampler {
 public:
  FaceSampler(const VisibilityBuffer& buffer, const RenderScene& scene, const Paint& paint,
              const Eigen::Matrix3f& view_from_model)
      : buffer_(buffer), scene_(scene), paint_(paint), view_from_model_(view_from_model) {}

  [[nodiscard]] Shard at(std::uint32_t id, int px, int py) {
    if (id != id_) {
      load(id);
    }
    const float x = static_cast<float>((px << kFixedBits) + (1 << (kFixedBits - 1)) - a_.x);
    const float y = static_cast<float>((py << kFixedBits) + (1 << (kFixedBits - 1)) - a_.y);
    const float wb = std::clamp((x * edge_c_.y() - y * edge_c_.x()) * per_area_, 0.0F, 1.0F);
    const float wc = std::clamp((y * edge_b_.x() - x * edge_b_.y()) * per_area_, 0.0F, 1.0F - wb);
    const float wa = 1.0F - wb - wc;
    Shard shard;
    if (is_back_) {
      shard.colour = inside_;
      shard.plain = true;
      return shard;
    }
    shard.normal = wa * normals_[0] + wb * normals_[1] + wc * normals_[2];
    const float length = shard.normal.norm();
    // A vertex normal may lean away from a viewer who does see the face.
    if (length < 1e-6F) {
      shard.normal = {0, 0, 1};
    } else {
      shard.normal /= length;
      shard.normal.z() = std::max(shard.normal.z(), 0.02F);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      shard.colour[k] = wa * colours_[0][k] + wb * colours_[1][k] + wc * colours_[2][k];
    }
    return shard;
  }

 private:
  void load(std::uint32_t id) {
    id_ = id;
    const auto& face = scene_.faces()[id];
    a_ = buffer_.vertices[face[0]];
    const ProjectedVertex& b = buffer_.vertices[face[1]];
    const ProjectedVertex& c = buffer_.vertices[face[2]];
    edge_b_ = {static_cast<float>(b.x - a_.x), static_cast<float>(b.y - a_.y)};
    edge_c_ = {static_cast<float>(c.x - a_.x), static_cast<float>(c.y - a_.y)};
    const float area = edge_b_.x() * edge_c_.y() - edge_c_.x() * edge_b_.y();
    // Rows run downwards, so a face that is counter-clockwise to the viewer has a negative area here.
    is_back_ = area > 0;
    per_area_ = area == 0 ? 0.0F : 1.0F / area;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3f& n = scene_.normals()[face[k]];
      normals_[k] = n.allFinite() ? Eigen::Vector3f(view_from_model_ * n) : Eigen::Vector3f(0, 0, 1);
      colours_[k] = paint_(face[k]);
    }
  }

  const VisibilityBuffer& buffer_;
  const RenderScene& scene_;
  const Paint& paint_;
  const Eigen::Matrix3f& view_from_model_;
  LinearRgb inside_ = to_linear(kInside);
  std::uint32_t id_ = kNothing;
  ProjectedVertex a_;
  Eigen::Vector2f edge_b_{0, 0}, edge_c_{0, 0};
  float per_area_ = 0;
  bool is_back_ = false;
  std::array<Eigen::Vector3f, 3> normals_{};
  std::array<LinearRgb, 3> colours_{};
};

SurfacePixels empty_pixels(int width, int height) {
  SurfacePixels out;
  out.width = width;
  out.height = height;
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (auto* field : {&out.coverage, &out.nx, &out.ny, &out.r, &out.g, &out.b, &out.plain}) {
    field->assign(count, 0.0F);
  }
  out.nz.assign(count, 1.0F);
  out.z_mm.assign(count, kFarAway);
  return out;
}

}  // namespace

SurfacePixels resolve(const VisibilityBuffer& buffer, const RenderScene& scene, const ViewCamera& camera,
                      RenderStyle style, int supersampling, std::span<const float> tone) {
  SurfacePixels out = empty_pixels(buffer.width / supersampling, buffer.height / supersampling);
  const Paint paint(scene.mesh(), style, tone);
  const Eigen::Matrix3f view_from_model = camera.view_from_model.cast<float>();
  const ColouredPoints* points = scene.points();
  const bool has_colours = points != nullptr && points->colours.size() == points->positions_mm.size();
  const float per_subpixel = 1.0F / static_cast<float>(supersampling * supersampling);

  const auto resolve_row = [&](std::size_t row) {
    FaceSampler face(buffer, scene, paint, view_from_model);
    for (int col = 0; col < out.width; ++col) {
      int covered = 0;
      int plain = 0;
      float z = 0;
      Eigen::Vector3f normal = Eigen::Vector3f::Zero();
      LinearRgb colour{};
      for (int sub = 0; sub < supersampling * supersampling; ++sub) {
        const int px = col * supersampling + sub % supersampling;
        const int py = static_cast<int>(row) * supersampling + sub / supersampling;
        const std::size_t at = static_cast<std::size_t>(py) * static_cast<std::size_t>(buffer.width) +
                               static_cast<std::size_t>(px);
        const std::uint32_t id = buffer.id[at];
        if (id == kNothing) {
          continue;
        }
        Shard shard;
        if ((id & kPointBit) != 0) {
          shard.plain = true;
          shard.colour = to_linear(has_colours ? points->colours[id & ~kPointBit] : kRedOfSparse);
        } else {
          shard = face.at(id, px, py);
        }
        ++covered;
        plain += shard.plain ? 1 : 0;
        z += buffer.z_mm[at];
        normal += shard.normal;
        for (std::size_t k = 0; k < 3; ++k) {
          colour[k] += shard.colour[k];
        }
      }
      if (covered == 0) {
        continue;
      }
      const std::size_t i = row * static_cast<std::size_t>(out.width) + static_cast<std::size_t>(col);
      const float share = 1.0F / static_cast<float>(covered);
      out.coverage[i] = static_cast<float>(covered) * per_subpixel;
      out.plain[i] = static_cast<float>(plain) * share;
      out.z_mm[i] = z * share;
      out.nx[i] = normal.x() * share;
      out.ny[i] = normal.y() * share;
      out.nz[i] = normal.z() * share;
      out.r[i] = colour[0] * share;
      out.g[i] = colour[1] * share;
      out.b[i] = colour[2] * share;
    }
  };
  parallel_for_each_index(static_cast<std::size_t>(out.height), resolve_row, 8);
  return out;
}

}  // namespace dubsar
