// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>

#include "core/rigid_transform.h"

namespace dubsar {

/// Keeps the order in which keys are set, so that the same values give the same bytes.
using OrderedJson = nlohmann::ordered_json;

[[nodiscard]] inline OrderedJson json_of(const Eigen::Vector3d& v) {
  return OrderedJson::array({v.x(), v.y(), v.z()});
}
[[nodiscard]] inline OrderedJson json_of(const RigidTransform& t) {
  return OrderedJson(t.row_major());
}
/// Numbers print so that they read back to the same double; NaN and infinity become null, bytes that are not
/// UTF-8 a replacement character.
[[nodiscard]] inline std::string text_of(const OrderedJson& json) {
  return json.dump(1, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

}  // namespace dubsar
