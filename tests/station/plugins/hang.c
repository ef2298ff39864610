/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */

/* A scanner whose driver does not come back: some scans of a bumpy field are whole, each later one hangs at a
 * row of it, whatever it is told, until the file that the locator names is there. With the option `deaf` it
 * goes on with that scan for ever instead, and answers that it could not be stopped. On standard error it
 * says that it hangs and that it was told to stop. */
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <threads.h>

#include "tests/support/plain_driver.h"

enum { COLS = 120, ROWS = 100, HANGS_AT = 20 };

struct dubsar_device {
  long whole; /* scans to come that do not hang */
  int deaf;
  atomic_int told;
  char release[1024];
};

static int32_t describe_options(dubsar_setting_callback callback, void* user, dubsar_error* error) {
  const dubsar_setting whole = {
      .struct_size = sizeof whole, .type = DUBSAR_TYPE_INTEGER, .flags = 2, .key = "whole", .help = "scans"};
  const dubsar_setting deaf = {.struct_size = sizeof deaf,
                               .type = DUBSAR_TYPE_INTEGER,
                               .flags = 2,
                               .key = "deaf",
                               .help = "to stop()"};
  (void)error;
  return callback(user, &whole) != 0 || callback(user, &deaf) != 0 ? DUBSAR_CANCELLED : DUBSAR_OK;
}

static int32_t discover(dubsar_device_callback callback, void* user, dubsar_error* error) {
  (void)error;
  return plain_one_device(callback, user, "hang:", "a scanner that hangs");
}

static int32_t open_device(const char* locator, const dubsar_option* options, uint32_t count,
                           dubsar_device** device, dubsar_error* error) {
  *device = calloc(1, sizeof **device);
  if (*device == NULL) {
    return plain_problem(error, DUBSAR_INTERNAL, "no memory");
  }
  (*device)->whole = 1;
  for (uint32_t i = 0; i < count; ++i) {
    const long value = strtol(options[i].value, NULL, 10);
    if (strcmp(options[i].key, "deaf") == 0) {
      (*device)->deaf = value != 0;
    } else {
      (*device)->whole = value;
    }
  }
  strncpy((*device)->release, locator, sizeof(*device)->release - 1);
  return DUBSAR_OK;
}

static void close_device(dubsar_device* device) {
  free(device);
}

static int32_t capabilities(dubsar_device* device, dubsar_capabilities* out, dubsar_error* error) {
  (void)device;
  (void)error;
  return plain_capabilities(0, "", out);
}

static void hang(const dubsar_device* device, int64_t row) {
  const struct timespec pause = {0, 20000000};
  if (device->deaf) {
    fputs(row == HANGS_AT ? "hang: scans on\n" : "", stderr);
    thrd_sleep(&pause, NULL);
    return;
  }
  fputs("hang: hangs\n", stderr);
  for (FILE* file = NULL; file == NULL;) {
    thrd_sleep(&pause, NULL);
    file = fopen(device->release, "r");
    if (file != NULL) {
      fclose(file);
      break;
    }
  }
}

static int32_t scan(dubsar_device* device, const dubsar_sink* sink, dubsar_error* error) {
  const float high = 0.4f + 0.01f * (float)device->whole; /* no two scans are the same */
  const int hangs = device->whole-- <= 0;
  const int64_t rows = hangs && device->deaf ? INT64_MAX : ROWS;
  float x[COLS], y[COLS], z[COLS];
  dubsar_scan_end end = {.struct_size = sizeof end};
  const dubsar_scan_info info = plain_scan_info(COLS, 0.2, "hang");
  if (sink->begin(sink->user, &info) != 0) {
    return plain_cancelled(sink, &end, error);
  }
  for (int64_t row = 0; row < rows; ++row) {
    const dubsar_profile profile = {
        .struct_size = sizeof profile, .count = COLS, .row = row, .x = x, .y = y, .z = z};
    if (hangs && (row == HANGS_AT || (device->deaf && row > HANGS_AT))) {
      hang(device, row);
    }
    for (int col = 0; col < COLS; ++col) {
      x[col] = 0.2f * (float)col;
      y[col] = 0.2f * (float)row;
      z[col] = high * sinf(0.9f * x[col]) * cosf(1.3f * y[col]) + 0.3f * sinf(0.31f * x[col] * y[col]);
    }
    if (sink->profile(sink->user, &profile) != 0) {
      return plain_cancelled(sink, &end, error);
    }
    ++end.profiles_sent;
  }
  sink->end(sink->user, &end);
  return DUBSAR_OK;
}

/* It comes back, as it must; what it was to stop does not. */
static int32_t stop(dubsar_device* device, dubsar_error* error) {
  if (atomic_exchange(&device->told, 1) == 0) {
    fputs("hang: told to stop\n", stderr);
  }
  return device->deaf ? plain_problem(error, DUBSAR_DEVICE, "the controller does not answer") : DUBSAR_OK;
}

const dubsar_driver* dubsar_driver_entry(void) {
  static const dubsar_driver driver = {
      .abi_version = DUBSAR_DRIVER_ABI_VERSION,
      .struct_size = sizeof(dubsar_driver),
      .scheme = "hang",
      .description = "a scanner for tests that hangs",
      .version = "1",
      .locator_help = "FILE",
      .describe_options = describe_options,
      .discover = discover,
      .open = open_device,
      .close = close_device,
      .capabilities = capabilities,
      .stop = stop,
      .scan = scan,
  };
  return &driver;
}
