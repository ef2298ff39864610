// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

namespace dubsar {

/// From now on the threads that help in parallel loops (core/parallel.h) yield to the others of this process:
/// a window must answer while all cores compute. Who calls such a loop keeps its own priority
/// (yield_this_thread()). To be called before the first loop: threads that there are already are reached as
/// far as they are free.
void make_loops_yield();

}  // namespace dubsar
