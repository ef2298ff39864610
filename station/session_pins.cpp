// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/session_pins.h"

#include "acquisition/operator_log.h"
#include "formats/pins_json.h"

namespace dubsar {

namespace {

constexpr const char* kFile = "pins";
/// Beside the file and not in it: a session that goes on with the same file must not lose what was clicked.
constexpr const char* kClicked = "pin_labels";

Result<std::optional<PinSet>> load(const SessionStore& store, const char* name) {
  const auto text = store.load_document(name);
  if (!text) {
    return std::unexpected(text.error());
  }
  if (!*text) {
    return std::nullopt;
  }
  Result<PinSet> pins = parse_pins(**text, (store.folder() / "session.sqlite").string() + " (" + name + ")");
  if (!pins) {
    return std::unexpected(pins.error());
  }
  return std::optional(std::move(*pins));
}

}  // namespace

Result<std::optional<PinSet>> session_pins(const SessionStore& store, const std::optional<PinSet>& given) {
  Result<std::optional<PinSet>> pins = given ? Result<std::optional<PinSet>>(given) : load(store, kFile);
  if (!pins) {
    return pins;
  }
  const Result<std::optional<PinSet>> clicked = load(store, kClicked);
  if (!clicked || !*clicked || (*clicked)->tips.empty()) {  // none there, or all taken back
    return clicked ? pins : clicked;
  }
  if (!*pins) {
    return clicked;
  }
  (*pins)->tip_diameter_mm = (*clicked)->tip_diameter_mm;
  for (const auto& [id, tips] : (*clicked)->tips) {
    (*pins)->tips[id] = tips;
  }
  return pins;
}

Status keep_pin_labels(SessionStore& store, int id, const std::vector<PinTip>& tips, double tip_diameter_mm) {
  if (const Status stands = check_scan_stands(store, id); !stands) {
    return stands;
  }
  Result<std::optional<PinSet>> clicked = load(store, kClicked);
  if (!clicked) {
    return std::unexpected(clicked.error());
  }
  PinSet all = *clicked ? std::move(**clicked) : PinSet{};
  all.tip_diameter_mm = tip_diameter_mm;
  if (tips.empty()) {
    all.tips.erase(id);
  } else {
    all.tips[id] = tips;
  }
  const std::string text = pins_to_json(all);
  // What could not be read again must not be stored.
  const std::string where = "labels of scan " + std::to_string(id);
  if (const Result<PinSet> good = parse_pins(text, where); !good) {
    return fail(ErrorKind::kUsage, good.error().what, where, good.error().mend);
  }
  if (const Status saved = store.save_document(kClicked, text); !saved) {
    return saved;
  }
  PinSet said;
  said.tip_diameter_mm = tip_diameter_mm;
  said.tips[id] = tips;
  return store.append_event("pins labelled", pins_to_json(said));
}

}  // namespace dubsar
