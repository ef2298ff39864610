// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>
#include <vector>

#include "acquisition/session_store.h"
#include "core/pin_set.h"
#include "core/result.h"

namespace dubsar {

/// What a session knows of its pins: the pins file that it was begun with, and over it, scan by scan, what
/// the operator has clicked since. Pins that a run was `given` stand in for the file before they are kept.
/// Nothing where there are none. Errors: kBadInput when what is stored cannot be read, and those of
/// SessionStore::load_document.
[[nodiscard]] Result<std::optional<PinSet>> session_pins(const SessionStore& store,
                                                         const std::optional<PinSet>& given = std::nullopt);

/// Keeps the operator's labels of one scan, in place of those before; no tips takes them back, and the pins
/// file holds again. Errors: kUsage for a scan that does not stand or tips that cannot be
/// (a label twice, a diameter outside of 0.01 to 50 mm, a place that is no number), and those of the store.
Status keep_pin_labels(SessionStore& store, int id, const std::vector<PinTip>& tips, double tip_diameter_mm);

}  // namespace dubsar
