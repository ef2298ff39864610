// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/raster.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace dubsar {

namespace {

constexpr int kBandRows = 32;
constexpr std::size_t kFaceGrain = 1 << 14;
constexpr std::int32_t kUnit = 1 << kFixedBits;
constexpr std::int32_t kHalf = kUnit / 2;

/// First subpixel whose centre is at or after a fixed-point coordinate.
int first_centre(std::int32_t fixed) {
  return (fixed - kHalf + kUnit - 1) >> kFixedBits;
}
/// Last subpixel whose centre is at or before a fixed-point coordinate.
int last_centre(std::int32_t fixed) {
  return (fixed - kHalf) >> kFixedBits;
}

struct Rows {
  int begin = 0;
  int end = 0;
};

/// Subpixel rows whose centres a face can cover; empty for a face that falls between the centres.
Rows rows_of(const VisibilityBuffer& buffer, const RenderScene::Face3& face) {
  const ProjectedVertex& a = buffer.vertices[face[0]];
  const ProjectedVertex& b = buffer.vertices[face[1]];
  const ProjectedVertex& c = buffer.vertices[face[2]];
  const auto [x_low, x_high] = std::minmax({a.x, b.x, c.x});
  if (first_centre(x_low) > last_centre(x_high)) {
    return {};
  }
  const auto [y_low, y_high] = std::minmax({a.y, b.y, c.y});
  return {std::max(0, first_centre(y_low)), std::min(buffer.height, last_centre(y_high) + 1)};
}

/// Faces by band of rows: a counting sort whose chunks depend on the number of faces alone, so that each
/// band lists its faces in ascending order.
struct Bins {
  std::vector<std::uint32_t> start;  ///< [bands + 1]
  std::vector<std::uint32_t> faces;
};

Bins bin_faces(const VisibilityBuffer& buffer, std::span<const RenderScene::Face3> faces) {
  const auto bands = static_cast<std::size_t>((buffer.height + kBandRows - 1) / kBandRows);
  const std::size_t chunks = (faces.size() + kFaceGrain - 1) / kFaceGrain;
  std::vector<std::uint32_t> cursor(chunks * bands, 0);
  const auto visit = [&](std::size_t begin, std::size_t end, const auto& put) {
    for (std::size_t i = begin; i < end; ++i) {
      const Rows rows = rows_of(buffer, faces[i]);
      if (rows.begin < rows.end) {
        for (int band = rows.begin / kBandRows; band <= (rows.end - 1) / kBandRows; ++band) {
          put(i, static_cast<std::size_t>(band));
        }
      }
    }
  };
  parallel_chunks(faces.size(), kFaceGrain, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* counts = cursor.data() + begin / kFaceGrain * bands;
    visit(begin, end, [&](std::size_t, std::size_t band) { ++counts[band]; });
  });
  Bins bins;
  bins.start.assign(bands + 1, 0);
  std::uint32_t total = 0;
  for (std::size_t band = 0; band < bands; ++band) {
    bins.start[band] = total;
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
      const std::uint32_t count = cursor[chunk * bands + band];
      cursor[chunk * bands + band] = total;
      total += count;
    }
  }
  bins.start[bands] = total;
  bins.faces.resize(total);
  parallel_chunks(faces.size(), kFaceGrain, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* cursors = cursor.data() + begin / kFaceGrain * bands;
    visit(begin, end, [&](std::size_t i, std::size_t band) {
      bins.faces[cursors[band]++] = static_cast<std::uint32_t>(i);
    });
  });
  return bins;
}

/// One edge as a function that grows by fixed steps from subpixel to subpixel; inside is >= 0.
struct Edge {
  std::int64_t value, step_x, step_y;

  Edge(const ProjectedVertex& from, const ProjectedVertex& to, int px, int py) {
    const std::int64_t dx = to.x - from.x;
    const std::int64_t dy = to.y - from.y;
    const std::int64_t x = static_cast<std::int64_t>(px) * kUnit + kHalf - from.x;
    const std::int64_t y = static_cast<std::int64_t>(py) * kUnit + kHalf - from.y;
    const bool owns_its_line = dy < 0 || (dy == 0 && dx > 0);
    value = dx * y - dy * x - (owns_its_line ? 0 : 1);
    step_x = -dy * kUnit;
    step_y = dx * kUnit;
  }
};

void draw_face(VisibilityBuffer& buffer, const RenderScene::Face3& face, std::uint32_t id, Rows band) {
  const ProjectedVertex& a = buffer.vertices[face[0]];
  const ProjectedVertex* b = &buffer.vertices[face[1]];
  const ProjectedVertex* c = &buffer.vertices[face[2]];
  const auto doubled_area = [&] {
    return static_cast<std::int64_t>(b->x - a.x) * (c->y - a.y) -
           static_cast<std::int64_t>(c->x - a.x) * (b->y - a.y);
  };
  std::int64_t area = doubled_area();
  if (area < 0) {
    std::swap(b, c);
    area = -area;
  }
  if (area == 0) {
    return;
  }
  const auto [x_low, x_high] = std::minmax({a.x, b->x, c->x});
  const auto [y_low, y_high] = std::minmax({a.y, b->y, c->y});
  const auto [z_low, z_high] = std::minmax({a.z_mm, b->z_mm, c->z_mm});
  const int px_begin = std::max(0, first_centre(x_low));
  const int px_end = std::min(buffer.width, last_centre(x_high) + 1);
  const int py_begin = std::max(band.begin, first_centre(y_low));
  const int py_end = std::min(band.end, last_centre(y_high) + 1);
  Edge ab(a, *b, px_begin, py_begin);
  Edge bc(*b, *c, px_begin, py_begin);
  Edge ca(*c, a, px_begin, py_begin);
  // The plane of depths; a sliver's plane is steep, so depths are kept between those of its corners.
  const double per_area = 1.0 / static_cast<double>(area);
  const double zb = b->z_mm - a.z_mm;
  const double zc = c->z_mm - a.z_mm;
  const double slope_x = (zb * (c->y - a.y) - zc * (b->y - a.y)) * per_area;
  const double slope_y = (zc * (b->x - a.x) - zb * (c->x - a.x)) * per_area;
  for (int py = py_begin; py < py_end; ++py) {
    std::int64_t e0 = ab.value;
    std::int64_t e1 = bc.value;
    std::int64_t e2 = ca.value;
    const std::size_t row = static_cast<std::size_t>(py) * static_cast<std::size_t>(buffer.width);
    const double z_row = a.z_mm + slope_y * (static_cast<double>(py) * kUnit + kHalf - a.y);
    for (int px = px_begin; px < px_end; ++px) {
      if ((e0 | e1 | e2) >= 0) {
        const double plane = z_row + slope_x * (static_cast<double>(px) * kUnit + kHalf - a.x);
        const float z = std::clamp(static_cast<float>(plane), z_low, z_high);
        const std::size_t at = row + static_cast<std::size_t>(px);
        if (z > buffer.z_mm[at]) {
          buffer.z_mm[at] = z;
          buffer.id[at] = id;
        }
      }
      e0 += ab.step_x;
      e1 += bc.step_x;
      e2 += ca.step_x;
    }
    ab.value += ab.step_y;
    bc.value += bc.step_y;
    ca.value += ca.step_y;
  }
}

/// A point on the picture, in subpixels.
struct Disc {
  float x, y, z_mm;
  std::uint32_t id;
};

/// Discs of a band, the nearest first decided among themselves and then against the faces, so that a point
/// just below the mesh still shows.
void draw_discs(VisibilityBuffer& buffer, const std::vector<Disc>& discs, float radius_px, float bury_mm,
                Rows band) {
  const auto width = static_cast<std::size_t>(buffer.width);
  std::vector<float> nearest;
  std::vector<std::uint32_t> owner;
  for (const Disc& disc : discs) {
    const int py_begin = std::max(band.begin, static_cast<int>(std::ceil(disc.y - radius_px - 0.5F)));
    const int py_end = std::min(band.end, static_cast<int>(std::floor(disc.y + radius_px - 0.5F)) + 1);
    if (py_begin >= py_end) {
      continue;
    }
    if (nearest.empty()) {
      const std::size_t cells = static_cast<std::size_t>(band.end - band.begin) * width;
      nearest.assign(cells, -std::numeric_limits<float>::infinity());
      owner.assign(cells, kNothing);
    }
    const int px_begin = std::max(0, static_cast<int>(std::ceil(disc.x - radius_px - 0.5F)));
    const int px_end = std::min(buffer.width, static_cast<int>(std::floor(disc.x + radius_px - 0.5F)) + 1);
    for (int py = py_begin; py < py_end; ++py) {
      const float dy = static_cast<float>(py) + 0.5F - disc.y;
      for (int px = px_begin; px < px_end; ++px) {
        const float dx = static_cast<float>(px) + 0.5F - disc.x;
        const std::size_t at =
            static_cast<std::size_t>(py - band.begin) * width + static_cast<std::size_t>(px);
        if (dx * dx + dy * dy <= radius_px * radius_px && disc.z_mm > nearest[at]) {
          nearest[at] = disc.z_mm;
          owner[at] = disc.id;
        }
      }
    }
  }
  const std::size_t first = static_cast<std::size_t>(band.begin) * width;
  for (std::size_t i = 0; i < owner.size(); ++i) {
    if (owner[i] != kNothing && nearest[i] >= buffer.z_mm[first + i] - bury_mm) {
      buffer.id[first + i] = kPointBit | owner[i];
      buffer.z_mm[first + i] = std::max(nearest[i], buffer.z_mm[first + i]);
    }
  }
}

}  // namespace

VisibilityBuffer rasterise(const RenderScene& scene, const ViewCamera& camera, const Framing& framing,
                           int supersampling) {
  VisibilityBuffer buffer;
  buffer.width = framing.width_px * supersampling;
  buffer.height = framing.height_px * supersampling;
  const std::size_t cells = static_cast<std::size_t>(buffer.width) * static_cast<std::size_t>(buffer.height);
  buffer.id.assign(cells, kNothing);
  buffer.z_mm.assign(cells, -std::numeric_limits<float>::infinity());

  const double per_mm = supersampling / framing.mm_per_px;
  const auto to_subpixels = [&](const Eigen::Vector3f& p) -> Eigen::Vector3d {
    const Eigen::Vector3d v = camera.view_from_model * p.cast<double>();
    return {(v.x() - framing.left_mm) * per_mm, (framing.top_mm - v.y()) * per_mm, v.z() - framing.middle_mm};
  };
  const auto& positions = scene.mesh().positions;
  buffer.vertices.resize(positions.size());
  parallel_for_each_index(positions.size(), [&](std::size_t i) {
    const Eigen::Vector3d s = to_subpixels(positions[i]);
    // Vertices without a sound face may lie anywhere; they are never drawn.
    if (std::abs(s.x()) < 1e6 && std::abs(s.y()) < 1e6) {
      buffer.vertices[i] = {static_cast<std::int32_t>(std::lround(s.x() * kUnit)),
                            static_cast<std::int32_t>(std::lround(s.y() * kUnit)), static_cast<float>(s.z())};
    }
  });

  std::vector<Disc> discs;
  float radius_px = 0;
  if (const ColouredPoints* points = scene.points()) {
    radius_px = std::max(0.75F, static_cast<float>(points->radius_mm * per_mm));
    const bool has_normals = points->normals.size() == points->positions_mm.size();
    for (std::size_t i = 0; i < points->positions_mm.size(); ++i) {
      const Eigen::Vector3f& p = points->positions_mm[i];
      if (p.allFinite() &&
          (!has_normals || camera.view_from_model.row(2).dot(points->normals[i].cast<double>()) > 0)) {
        const Eigen::Vector3f s = to_subpixels(p).cast<float>();
        discs.push_back({s.x(), s.y(), s.z(), static_cast<std::uint32_t>(i)});
      }
    }
  }

  const auto faces = scene.faces();
  const Bins bins = bin_faces(buffer, faces);
  parallel_for_each_index(
      bins.start.size() - 1,
      [&](std::size_t b) {
        const int begin = static_cast<int>(b) * kBandRows;
        const Rows band{begin, std::min(begin + kBandRows, buffer.height)};
        for (std::uint32_t i = bins.start[b]; i < bins.start[b + 1]; ++i) {
          draw_face(buffer, faces[bins.faces[i]], bins.faces[i], band);
        }
        if (!discs.empty()) {
          draw_discs(buffer, discs, radius_px, scene.points()->bury_mm, band);
        }
      },
      1);
  return buffer;
}

}  // namespace dubsar
