/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */
#include "drivers/driver.h"

const dubsar_driver* dubsar_driver_entry(void) {
  static const dubsar_driver driver = {
      .abi_version = DUBSAR_DRIVER_ABI_VERSION, .struct_size = 24, .scheme = "small"};
  return &driver;
}
