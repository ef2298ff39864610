/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */

/* The driver sim: as a scanner with motors whose tablet people turn: it is told of a turn by hand when the
 * motors are to move. On standard error it says what moves and that it scans. */
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/plain_driver.h"

static const dubsar_driver* sim;

static int32_t place(dubsar_device* device, const dubsar_placement* placement, dubsar_error* error) {
  fprintf(stderr, "hands: moves%s\n", placement->has_hand_turn != 0 ? ", the tablet was turned" : "");
  return sim->place(device, placement, error);
}

static int32_t scan(dubsar_device* device, const dubsar_sink* sink, dubsar_error* error) {
  fprintf(stderr, "hands: scans\n");
  return sim->scan(device, sink, error);
}

const dubsar_driver* dubsar_driver_entry(void) {
  static dubsar_driver driver;
  typedef const dubsar_driver* (*entry)(void);
  void* library = dlopen(SIM_DRIVER, RTLD_NOW | RTLD_LOCAL);
  void* symbol = library != NULL ? dlsym(library, DUBSAR_DRIVER_ENTRY) : NULL;
  entry of_sim = NULL;
  if (symbol == NULL) {
    return NULL;
  }
  memcpy(&of_sim, &symbol, sizeof of_sim);
  sim = of_sim();
  memset(&driver, 0, sizeof driver);
  memcpy(&driver, sim, sim->struct_size < sizeof driver ? sim->struct_size : sizeof driver);
  driver.struct_size = sizeof driver;
  driver.scheme = "hands";
  driver.description = "a scanner with motors, whose tablet is turned by hand";
  driver.place = place;
  driver.scan = scan;
  return &driver;
}
