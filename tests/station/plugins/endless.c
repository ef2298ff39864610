/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */

/* The driver replay: as a scanner without motors and without an end, such as most are: nothing drives it, and
 * whoever stands beside it says when it scans. */
#include <dlfcn.h>
#include <string.h>

#include "tests/support/plain_driver.h"

static const dubsar_driver* replay;

static int32_t capabilities(dubsar_device* device, dubsar_capabilities* out, dubsar_error* error) {
  const int32_t code = replay->capabilities(device, out, error);
  out->flags &= ~(uint32_t)DUBSAR_IS_FINITE;
  out->scan_count = -1;
  return code;
}

const dubsar_driver* dubsar_driver_entry(void) {
  static dubsar_driver driver;
  typedef const dubsar_driver* (*entry)(void);
  void* library = dlopen(REPLAY_DRIVER, RTLD_NOW | RTLD_LOCAL);
  void* symbol = library != NULL ? dlsym(library, DUBSAR_DRIVER_ENTRY) : NULL;
  entry of_replay = NULL;
  if (symbol == NULL) {
    return NULL;
  }
  memcpy(&of_replay, &symbol, sizeof of_replay);
  replay = of_replay();
  memset(&driver, 0, sizeof driver);
  memcpy(&driver, replay, replay->struct_size < sizeof driver ? replay->struct_size : sizeof driver);
  driver.struct_size = sizeof driver;
  driver.scheme = "endless";
  driver.description = "scans that were recorded, as of a scanner that nothing drives";
  driver.capabilities = capabilities;
  return &driver;
}
