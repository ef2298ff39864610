/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */

/* Another driver as a scanner without motors and without an end, such as most are: nothing drives it, and
 * whoever stands beside it says when it scans. */
#include <dlfcn.h>
#include <string.h>

#include "tests/support/plain_driver.h"

static const dubsar_driver* wrapped;

static int32_t capabilities(dubsar_device* device, dubsar_capabilities* out, dubsar_error* error) {
  const int32_t code = wrapped->capabilities(device, out, error);
  out->flags &= ~(uint32_t)DUBSAR_IS_FINITE;
  out->scan_count = -1;
  return code;
}

const dubsar_driver* dubsar_driver_entry(void) {
  static dubsar_driver driver;
  typedef const dubsar_driver* (*entry)(void);
  void* library = dlopen(WRAPPED_DRIVER, RTLD_NOW | RTLD_LOCAL);
  void* symbol = library != NULL ? dlsym(library, DUBSAR_DRIVER_ENTRY) : NULL;
  entry of_it = NULL;
  if (symbol == NULL) {
    return NULL;
  }
  memcpy(&of_it, &symbol, sizeof of_it);
  wrapped = of_it();
  memset(&driver, 0, sizeof driver);
  memcpy(&driver, wrapped, wrapped->struct_size < sizeof driver ? wrapped->struct_size : sizeof driver);
  driver.struct_size = sizeof driver;
  driver.scheme = WRAPPED_AS;
  driver.description = "a scanner that nothing drives";
  driver.capabilities = capabilities;
  driver.place = NULL;
  return &driver;
}
