// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/job.h"
#include "core/mesh.h"
#include "core/red_map.h"
#include "core/result.h"
#include "planning/excuse.h"
#include "planning/next_view.h"
#include "planning/red_targets.h"

namespace dubsar {

struct RedMapOptions {
  ModelSurfaceOptions surface;
  RedTargetOptions targets;
  ExcuseOptions excuse;
  NextViewOptions next;
  /// Where the tablet lies now. Without it the last scan's placement is taken to be turntable 0, tilt 0.
  std::optional<StageState> stage;
};

/// The red map and what the next stages and pictures need of the way there.
struct RedMapResult {
  RedMap map;
  std::vector<SampleFlags> flags;  ///< of each scan of the span, with kExcused set
  RedTargets targets;
};

/// What is still missing, in one call: gathers the red samples of the registered scans (their flags as
/// ClearedMap::scans() gives them), estimates what nobody has seen, excuses what is not needed or out of
/// reach, groups the rest into regions and ranks the next views. Conclusive: there is a registered scan and
/// no region is red.
///
/// scans: registered scans only. model: the mesh so far, or null (then the scans cast the shadows). rig: null
/// in replay; then nothing is excused by pose limits, and the views go by hand around the model. Errors:
/// kCancelled.
[[nodiscard]] Result<RedMapResult> make_red_map(std::span<const PlacedScan> scans, const Mesh* model,
                                                const Rig* rig, const RedMapOptions& options,
                                                JobContext& job);

}  // namespace dubsar
