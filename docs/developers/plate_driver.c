/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */

/* A whole driver, about as small as one can be, to begin yours with (add-a-driver.md builds and runs it). Its
 * device is a plate of 30 x 20 mm with a relief, which it makes up: your device's own calls go where it does
 * so. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/driver.h"

enum { COLS = 301, ROWS = 201, kMostScans = 9 };
static const double kSpacingMm = 0.1;

struct dubsar_device {
  long left; /* scans to come */
};

/* The caller has cleared the error: where, what, and what to do about it. */
static int32_t problem(dubsar_error* error, int32_t code, const char* what, const char* mend) {
  error->code = code;
  snprintf(error->what, sizeof error->what, "%s", what);
  snprintf(error->mend, sizeof error->mend, "%s", mend);
  return code;
}

/* One call for each ?key=value. The program refuses other keys; values are open_device()'s to check. */
static int32_t describe_options(dubsar_setting_callback callback, void* user, dubsar_error* error) {
  const dubsar_setting scans = {.struct_size = sizeof scans,
                                .type = DUBSAR_TYPE_INTEGER,
                                .flags = DUBSAR_SETTING_WRITABLE,
                                .key = "scans",
                                .help = "how many times the plate is scanned; default: 1",
                                .minimum = 1,
                                .maximum = kMostScans};
  (void)error;
  return callback(user, &scans) != 0 ? DUBSAR_CANCELLED : DUBSAR_OK;
}

/* One call for each device that is plugged in. */
static int32_t discover(dubsar_device_callback callback, void* user, dubsar_error* error) {
  const dubsar_device_info plate = {sizeof plate, "plate:1", "a plate with a relief"};
  (void)error;
  return callback(user, &plate) != 0 ? DUBSAR_CANCELLED : DUBSAR_OK;
}

/* locator: what stands between "plate:" and '?'. */
static int32_t open_device(const char* locator, const dubsar_option* options, uint32_t count,
                           dubsar_device** device, dubsar_error* error) {
  if (strcmp(locator, "1") != 0) {
    return problem(error, DUBSAR_DEVICE, "there is no such plate", "name plate:1");
  }
  long scans = 1;
  for (uint32_t i = 0; i < count; ++i) { /* "scans" is the only key that comes */
    char* end = NULL;
    scans = strtol(options[i].value, &end, 10);
    if (*end != '\0' || scans < 1 || scans > kMostScans) {
      return problem(error, DUBSAR_USAGE, "scans= is no number from 1 to 9", "see dubsar drivers");
    }
  }
  *device = calloc(1, sizeof **device);
  if (*device == NULL) {
    return problem(error, DUBSAR_INTERNAL, "no memory", "close other programs");
  }
  (*device)->left = scans;
  return DUBSAR_OK;
}

static void close_device(dubsar_device* device) {
  free(device);
}

/* Where the scanner looks from is told twice: here, and with each scan. */
static dubsar_view view_of_plate(void) {
  const dubsar_view view = {.struct_size = sizeof view,
                            .flags = DUBSAR_VIEW_LASER | DUBSAR_VIEW_CAMERA,
                            .direction = {0, 0, -1}, /* z goes towards the scanner */
                            .laser_mm = {0, -10, 250},
                            .camera_mm = {0, 100, 250},
                            .motion_per_row_mm = {0, 0.1, 0}}; /* kSpacingMm */
  return view;
}

static int32_t capabilities(dubsar_device* device, dubsar_capabilities* out, dubsar_error* error) {
  dubsar_capabilities filled;
  (void)device, (void)error;
  memset(&filled, 0, sizeof filled);
  /* The program may be older than this driver: never a byte beyond what it has lent. */
  filled.struct_size = out->struct_size < sizeof filled ? out->struct_size : (uint32_t)sizeof filled;
  filled.flags = DUBSAR_HAS_RIG | DUBSAR_HAS_HAND_TURNS | DUBSAR_IS_FINITE;
  filled.scan_count = -1; /* not known beforehand */
  filled.spacing_mm = kSpacingMm;
  filled.field_x_mm = 40;
  filled.field_y_mm = 40;
  filled.depth_range_mm = 20;
  filled.calibration_age_days = -1; /* not known */
  filled.view = view_of_plate();
  strcpy(filled.name, "plate");
  memcpy(out, &filled, filled.struct_size);
  return DUBSAR_OK;
}

/* Row `row` as the device would send it. */
static void take_profile(int row, float* x, float* y, float* z, uint8_t* valid) {
  for (int col = 0; col < COLS; ++col) {
    x[col] = (float)(kSpacingMm * (col - COLS / 2));
    y[col] = (float)(kSpacingMm * (row - ROWS / 2));
    z[col] = 0.5f * sinf(0.9f * x[col] + 0.4f * y[col]) * cosf(0.7f * y[col] - 0.2f * x[col]);
    valid[col] =
        x[col] * x[col] + y[col] * y[col] > 4; /* a hole of 4 mm in the middle: no return from there */
  }
}

/* begin once, profile per row, end once, whatever happened after begin. */
static int32_t scan(dubsar_device* device, const dubsar_sink* sink, dubsar_error* error) {
  const dubsar_scan_info info = {.struct_size = sizeof info,
                                 .cols = COLS,
                                 .expected_rows = ROWS,
                                 .spacing_mm = kSpacingMm,
                                 .view = view_of_plate(),
                                 .device_id = "plate-1"};
  dubsar_scan_end end = {.struct_size = sizeof end, .code = DUBSAR_OK};
  float x[COLS], y[COLS], z[COLS];
  uint8_t valid[COLS];
  if (device->left == 0) {
    return DUBSAR_END; /* no callback is made then */
  }
  --device->left;
  if (sink->begin(sink->user, &info) != 0) {
    end.code = DUBSAR_CANCELLED;
  }
  for (int row = 0; row < ROWS && end.code == DUBSAR_OK; ++row) {
    const dubsar_profile profile = {
        .struct_size = sizeof profile, .count = COLS, .row = row, .x = x, .y = y, .z = z, .valid = valid};
    take_profile(row, x, y, z, valid);
    ++end.profiles_sent;
    if (sink->profile(sink->user, &profile) != 0) {
      end.code = DUBSAR_CANCELLED; /* stop the motion here, then end as usual */
    }
  }
  sink->end(sink->user, &end);
  return end.code == DUBSAR_OK ? DUBSAR_OK : problem(error, DUBSAR_CANCELLED, "cancelled", "");
}

const dubsar_driver* dubsar_driver_entry(void) {
  static const dubsar_driver driver = {.abi_version = DUBSAR_DRIVER_ABI_VERSION,
                                       .struct_size = sizeof driver,
                                       .scheme = "plate",
                                       .description = "a made-up plate, to begin a driver with",
                                       .version = "1",
                                       .locator_help = "1",
                                       .describe_options = describe_options,
                                       .discover = discover,
                                       .open = open_device,
                                       .close = close_device,
                                       .capabilities = capabilities,
                                       .scan = scan};
  return &driver;
}
