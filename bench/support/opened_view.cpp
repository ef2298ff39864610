// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/opened_view.h"

#include <algorithm>
#include <cstdio>

#include "core/stage_times.h"
#include "core/tablet_frame.h"

namespace dubsar::bench {

using Clock = std::chrono::steady_clock;

double told(const char* what, Clock::time_point began) {
  const double s = seconds_since(began);
  std::printf("  %-34s %7.2f s\n", what, s);
  return s;
}

OpenedView open_view(const Mesh& mesh, double read_s) {
  OpenedView out;
  double sum = read_s;
  auto began = Clock::now();
  const RigidTransform tablet_from_model = tablet_frame(mesh);
  sum += told("which way it lies", began);
  began = Clock::now();
  out.shown = ui::shown_mesh(mesh);
  sum += told("blocks and levels of detail", began);
  for (const ui::ShownLevel& level : out.shown.coarser) {
    std::printf("    %zu faces, cells of %.3f mm\n", level.detail.faces.size(),
                static_cast<double>(level.detail.cell_mm));
  }
  began = Clock::now();
  out.view = std::make_unique<ui::SurfaceView>();
  out.view->show(out.shown);
  sum += told("to the graphics card", began);
  out.camera.eye_from_model = Eigen::Quaternionf(Eigen::Matrix3f(tablet_from_model.rotation.cast<float>()));
  out.camera.fit(out.shown.box_mm, static_cast<float>(kWidth) / kHeight);
  began = Clock::now();
  bool more = out.view->draw(out.camera, {}, kWidth, kHeight);
  sum += told("first picture", began);
  std::printf("  %-34s %7.2f s, %zu faces drawn, %.0f MB on the card\n", "all of it", sum,
              out.view->faces_drawn(), static_cast<double>(out.view->buffers()->bytes()) / 1e6);
  began = Clock::now();
  double longest = 0;
  while (more) {
    const auto one = Clock::now();
    more = out.view->draw(out.camera, {}, kWidth, kHeight);
    longest = std::max(longest, seconds_since(one));
  }
  told("then, until every face is there", began);
  std::printf("  %-34s %7.0f ms\n", "longest frame of that", 1000 * longest);
  return out;
}

}  // namespace dubsar::bench
