// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/job.h"
#include "triangulation/draft.h"

namespace dubsar {

/// Makes the faces of a draft, none of them gone, an oriented 2-manifold (make_manifold()). Fans that touched
/// in a vertex each get one of their own, and vertices in one place are drawn a thousandth of the way towards
/// what lies around them, farther where a compressed file would round that away: fans do not touch any more,
/// and whoever welds equal places, as STL has it, does not join them again. A fan that would cut something
/// there goes. A job that is cancelled leaves the draft half done.
void part_fans(Draft& draft, const JobContext& job = {});

}  // namespace dubsar
