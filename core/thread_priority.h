// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

namespace dubsar {

enum class ThreadPriority {
  kUsual,     ///< as all others: no right to more
  kHigh,      ///< a larger share of the processors
  kRealTime,  ///< before everything that is not
};

/// What a preferred thread takes. Packets wait for milliseconds, frames in their pool for half a second:
/// where both threads want one processor, of equals the second would wait until the first has had its 0.1 s.
enum class ThreadTakes { kFrames, kPackets };

/// Puts the calling thread before those that compute, as far as this user may (limits.conf(5): `rtprio`, else
/// `nice`): for a thread that takes what a device sends and does nothing else. Threads that it starts are
/// usual ones. Says what came of it; not to have the right is no error.
ThreadPriority prefer_this_thread(ThreadTakes what = ThreadTakes::kFrames);

/// Puts the calling thread, and those that it starts from now on, behind the others of this user: for what
/// computes while somebody works with a window. On a machine with nothing else to do it loses nothing.
void yield_this_thread();

}  // namespace dubsar
