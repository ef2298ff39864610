/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */

/* The driver sim: as a scanner with motors whose tablet people turn: it is told of a turn by hand when the
 * motors are to move. On standard error it says what moves and that it scans. */
#include <stdio.h>

#include "tests/support/wrapped_driver.h"

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
  sim = wrap_driver(SIM_DRIVER, "hands", "a scanner with motors, whose tablet is turned by hand", &driver);
  driver.place = place;
  driver.scan = scan;
  return sim != NULL ? &driver : NULL;
}
