/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */

/* Another driver as a scanner without motors and without an end, such as most are: nothing drives it, and
 * whoever stands beside it says when it scans. */
#include "tests/support/wrapped_driver.h"

static const dubsar_driver* wrapped;

static int32_t capabilities(dubsar_device* device, dubsar_capabilities* out, dubsar_error* error) {
  const int32_t code = wrapped->capabilities(device, out, error);
  out->flags &= ~(uint32_t)DUBSAR_IS_FINITE;
  out->scan_count = -1;
  return code;
}

const dubsar_driver* dubsar_driver_entry(void) {
  static dubsar_driver driver;
  wrapped = wrap_driver(WRAPPED_DRIVER, WRAPPED_AS, "a scanner that nothing drives", &driver);
  driver.capabilities = capabilities;
  driver.place = NULL;
  return wrapped != NULL ? &driver : NULL;
}
