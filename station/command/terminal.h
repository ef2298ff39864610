// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <string_view>

#include "core/job.h"

namespace dubsar {

/// Progress on standard error: a bar that redraws itself on a terminal, a plain line per stage and tenth
/// otherwise. Thread-safe.
[[nodiscard]] JobContext::ProgressSink terminal_progress();

/// Switches progress on and off; a verb that prints its own lines as things happen has no use for a bar.
void show_progress(bool on);

/// Ends a bar that stands on the terminal, so that the next line starts clean.
void finish_progress();

/// For verbs that drive a device: whoever reads what is said may go (`| tee` gets the same Ctrl-C), and what
/// was scanned is still brought to its place.
void outlive_readers();

/// Ctrl-C, SIGTERM and SIGHUP (of a terminal that is closed) cancel the job in good order; a Ctrl-C after
/// that ends the program at once. A SIGHUP that is ignored (nohup) stays so.
class InterruptScope {
 public:
  explicit InterruptScope(JobContext& job);
  ~InterruptScope();
  InterruptScope(const InterruptScope&) = delete;
  InterruptScope& operator=(const InterruptScope&) = delete;
};

}  // namespace dubsar
