/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */

/* The driver sim, held fast: whatever moves or scans does nothing until the file that the locator names is
 * there. For as long as it waits there is one of that name with ".at" behind it. */
#include <stdio.h>
#include <string.h>
#include <threads.h>

#include "tests/support/wrapped_driver.h"

static const dubsar_driver* sim;
static char release[1024]; /* of the one device that a test opens */

static void hold(void) {
  const struct timespec pause = {0, 5000000};
  char at[sizeof release + 4];
  FILE* file = NULL;
  snprintf(at, sizeof at, "%s.at", release);
  file = fopen(at, "w");
  if (file != NULL) {
    fclose(file);
  }
  for (file = NULL; file == NULL; file = fopen(release, "r")) {
    thrd_sleep(&pause, NULL);
  }
  fclose(file);
  remove(at);
}

static int32_t open_device(const char* locator, const dubsar_option* options, uint32_t count,
                           dubsar_device** device, dubsar_error* error) {
  strncpy(release, locator, sizeof release - 1);
  return sim->open("", options, count, device, error);
}

static int32_t place(dubsar_device* device, const dubsar_placement* placement, dubsar_error* error) {
  hold();
  return sim->place(device, placement, error);
}

static int32_t scan(dubsar_device* device, const dubsar_sink* sink, dubsar_error* error) {
  hold();
  return sim->scan(device, sink, error);
}

const dubsar_driver* dubsar_driver_entry(void) {
  static dubsar_driver driver;
  sim = wrap_driver(SIM_DRIVER, "held", "a simulated tablet whose scanner is held fast", &driver);
  driver.open = open_device;
  driver.place = place;
  driver.scan = scan;
  return sim != NULL ? &driver : NULL;
}
