// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/aravis/camera.h"
#include "drivers/aravis/glib.h"

namespace dubsar::aravis {

std::vector<FoundCamera> find_cameras() {
  std::vector<FoundCamera> out;
  arv_update_device_list();
  for (unsigned k = 0; k < arv_get_n_devices(); ++k) {
    out.push_back({text_of(arv_get_device_id(k)),
                   text_of(arv_get_device_vendor(k)) + " " + text_of(arv_get_device_model(k)) + ", " +
                       text_of(arv_get_device_protocol(k)) + " at " + text_of(arv_get_device_address(k))});
  }
  return out;
}

}  // namespace dubsar::aravis
