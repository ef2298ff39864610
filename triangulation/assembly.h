// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <functional>
#include <vector>

#include "core/job.h"
#include "core/mesh.h"
#include "triangulation/gap_fill.h"
#include "triangulation/ownership.h"
#include "triangulation/seam_closer.h"

namespace dubsar {

struct AssemblyOptions {
  SeamOptions seam;
  GapFillOptions gap;
  int least_component_faces = 40;
};

/// One mesh of the patches that assign_owners() left: vertices are the kept samples at their averaged places,
/// scan by scan; then seams and gaps are closed, specks removed, and what is left made an oriented
/// 2-manifold with boundary. Empty when the job was cancelled before that.
/// `laid` is called when no more is needed of the scans than their surfaces' lookup.
[[nodiscard]] Mesh assemble(const std::vector<OwnedScan>& scans, const AssemblyOptions& options,
                            const std::function<void()>& laid, const JobContext& job);

}  // namespace dubsar
