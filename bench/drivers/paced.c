/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */

/* A scanner in plain C that hands its profiles over one by one at a steady pace: 2048 samples each, 100 a
 * second, of a field with steep walls, which turn red. For benches of what follows a profile. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdlib.h>
#include <time.h>

#include "tests/support/plain_driver.h"

enum { COLS = 2048, ROWS = 600, PROFILES_PER_S = 100 };

struct dubsar_device {
  float x[COLS], y[COLS], z[COLS];
};

static int32_t discover(dubsar_device_callback callback, void* user, dubsar_error* error) {
  (void)error;
  return plain_one_device(callback, user, "paced:", "a scanner at a steady pace");
}

static int32_t open_device(const char* locator, const dubsar_option* options, uint32_t count,
                           dubsar_device** device, dubsar_error* error) {
  (void)locator;
  (void)options;
  (void)count;
  *device = calloc(1, sizeof **device);
  return *device != NULL ? DUBSAR_OK : plain_problem(error, DUBSAR_INTERNAL, "no memory");
}

static void close_device(dubsar_device* device) {
  free(device);
}

static int32_t capabilities(dubsar_device* device, dubsar_capabilities* out, dubsar_error* error) {
  (void)device;
  (void)error;
  return plain_capabilities(0, "PACED-1", out);
}

static void wait_until(const struct timespec* start, int64_t profile) {
  struct timespec due = *start;
  const int64_t ns = due.tv_nsec + profile * (1000000000 / PROFILES_PER_S);
  due.tv_sec += (time_t)(ns / 1000000000);
  due.tv_nsec = (long)(ns % 1000000000);
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, NULL) != 0) {
  }
}

static int32_t scan(dubsar_device* device, const dubsar_sink* sink, dubsar_error* error) {
  const float spacing = 0.025f;
  const dubsar_scan_info info = plain_scan_info(COLS, spacing, "paced PACED-1");
  dubsar_scan_end end = {sizeof end, DUBSAR_OK, 0, 0, 0};
  struct timespec start;
  if (sink->begin(sink->user, &info) != 0) {
    return plain_cancelled(sink, &end, error);
  }
  clock_gettime(CLOCK_MONOTONIC, &start);
  for (int64_t row = 0; row < ROWS; ++row) {
    const dubsar_profile profile = {.struct_size = sizeof profile,
                                    .count = COLS,
                                    .row = row,
                                    .x = device->x,
                                    .y = device->y,
                                    .z = device->z};
    for (int col = 0; col < COLS; ++col) {
      device->x[col] = spacing * (float)col;
      device->y[col] = spacing * (float)row;
      device->z[col] = 0.5f * sinf(0.4f * device->x[col]) * cosf(0.6f * device->y[col]) -
                       ((col / 64 + row / 48) % 5 == 0 ? 1.0f : 0.0f);
    }
    wait_until(&start, row);
    if (sink->profile(sink->user, &profile) != 0) {
      return plain_cancelled(sink, &end, error);
    }
    ++end.profiles_sent;
  }
  sink->end(sink->user, &end);
  return DUBSAR_OK;
}

const dubsar_driver* dubsar_driver_entry(void) {
  static const dubsar_driver driver = {
      .abi_version = DUBSAR_DRIVER_ABI_VERSION,
      .struct_size = sizeof(dubsar_driver),
      .scheme = "paced",
      .description = "a scanner for benches that hands its profiles over at a steady pace",
      .version = "1",
      .locator_help = "",
      .describe_options = plain_no_options,
      .discover = discover,
      .open = open_device,
      .close = close_device,
      .capabilities = capabilities,
      .scan = scan,
  };
  return &driver;
}
