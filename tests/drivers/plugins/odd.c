/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */

/* A driver in plain C that behaves as its option `mode` says: what a good device does on a bad day, and what
 * a faulty driver does. Two scans, then the end, for the modes that come to one. */
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/plain_driver.h"

enum { COLS = 8, ROWS = 6 };

struct dubsar_device {
  char mode[16];
  int scans;
  atomic_int scanning;
  double gain;
  int64_t average;
  char light[8];
  double turntable_rad;
};

static int32_t describe_options(dubsar_setting_callback callback, void* user, dubsar_error* error) {
  const dubsar_setting mode = {
      .struct_size = sizeof mode,
      .type = DUBSAR_TYPE_CHOICE,
      .flags = DUBSAR_SETTING_WRITABLE,
      .key = "mode",
      .help = "how to behave",
      .choices =
          "good|ragged|fail|forever|burns|silent|cols|points|late|empty|twisted|coarse|"
          "deep|high|ancient|largest",
      .minimum = 1,
      .maximum = 0};
  (void)error;
  return callback(user, &mode) != 0 ? DUBSAR_CANCELLED : DUBSAR_OK;
}

static int32_t discover(dubsar_device_callback callback, void* user, dubsar_error* error) {
  (void)error;
  return plain_one_device(callback, user, "odd:1", "an odd device");
}

static int32_t open_device(const char* locator, const dubsar_option* options, uint32_t count,
                           dubsar_device** device, dubsar_error* error) {
  if (strcmp(locator, "gone") == 0) {
    strncpy(error->mend, "plug it in", sizeof error->mend - 1);
    return plain_problem(error, DUBSAR_DEVICE, "no such device");
  }
  *device = calloc(1, sizeof **device);
  if (*device == NULL) {
    return plain_problem(error, DUBSAR_INTERNAL, "no memory");
  }
  strcpy((*device)->mode, "good");
  strcpy((*device)->light, "on");
  (*device)->gain = 1.0;
  (*device)->average = 1;
  for (uint32_t i = 0; i < count; ++i) {
    strncpy((*device)->mode, options[i].value, sizeof(*device)->mode - 1);
  }
  return DUBSAR_OK;
}

static void close_device(dubsar_device* device) {
  free(device);
}

/* The most that a rig may tell, in the mode that tells so of everything; more than that in the mode of its
 * own. */
static double told(const dubsar_device* device, const char* mode, double most, double mostly) {
  if (strcmp(device->mode, "largest") == 0) {
    return most;
  }
  return strcmp(device->mode, mode) == 0 ? 2 * most : mostly;
}

static int32_t capabilities(dubsar_device* device, dubsar_capabilities* out, dubsar_error* error) {
  dubsar_capabilities filled;
  (void)error;
  memset(&filled, 0, sizeof filled);
  filled.struct_size = out->struct_size;
  filled.flags = DUBSAR_HAS_RIG | DUBSAR_HAS_TURNTABLE | DUBSAR_HAS_TILT | DUBSAR_IS_FINITE;
  filled.scan_count = 2;
  filled.tilt_max_rad = strcmp(device->mode, "twisted") == 0 ? 1e306 : 1.0;
  filled.field_x_mm = filled.field_y_mm = 40;
  filled.spacing_mm = told(device, "coarse", 1e3, 0.5);
  filled.depth_range_mm = told(device, "deep", 1e6, 40);
  filled.support_height_mm = told(device, "high", 1e6, 0);
  filled.calibration_age_days = told(device, "ancient", 1e6, -1);
  filled.view.direction[2] = -1;
  filled.view.flags = DUBSAR_VIEW_LASER;
  filled.view.laser_mm[2] = 200;
  strcpy(filled.name, "odd rig");
  return plain_give_capabilities(&filled, out);
}

static int32_t describe_settings(dubsar_device* device, dubsar_setting_callback callback, void* user,
                                 dubsar_error* error) {
  const dubsar_setting settings[] = {
      {sizeof(dubsar_setting), DUBSAR_TYPE_NUMBER, 3, "gain", "of the sensor", "dB", NULL, 0, 10, 0.5},
      {sizeof(dubsar_setting), DUBSAR_TYPE_INTEGER, 3, "average", "frames per profile", NULL, NULL, 1, 16, 1},
      {sizeof(dubsar_setting), DUBSAR_TYPE_CHOICE, 3, "light", "of the laser", NULL, "on|off", 1, 0, 0},
      {sizeof(dubsar_setting), DUBSAR_TYPE_INTEGER, 1, "hours", "that it has run", "h", NULL, 1, 0, 0},
  };
  (void)device;
  (void)error;
  return plain_describe(settings, sizeof settings / sizeof settings[0], callback, user);
}

static int32_t get_setting(dubsar_device* device, const char* key, dubsar_value* value, dubsar_error* error) {
  (void)error;
  if (strcmp(key, "gain") == 0) {
    value->number = device->gain;
  } else if (strcmp(key, "average") == 0) {
    value->integer = device->average;
  } else if (strcmp(key, "hours") == 0) {
    value->integer = 1234;
  } else {
    strcpy(value->text, device->light);
  }
  return DUBSAR_OK;
}

static int32_t set_setting(dubsar_device* device, const char* key, const dubsar_value* value,
                           dubsar_error* error) {
  (void)error;
  if (strcmp(key, "gain") == 0) {
    device->gain = value->number;
  } else if (strcmp(key, "average") == 0) {
    device->average = value->integer;
  } else {
    strncpy(device->light, value->text, sizeof device->light - 1);
  }
  return DUBSAR_OK;
}

static int32_t place(dubsar_device* device, const dubsar_placement* placement, dubsar_error* error) {
  (void)error;
  device->turntable_rad = placement->turntable_rad;
  return DUBSAR_OK;
}

static void fill_row(float* x, float* y, float* z, int64_t row) {
  for (int col = 0; col < COLS; ++col) {
    x[col] = 0.5f * (float)col;
    y[col] = 0.5f * (float)row;
    z[col] = 0.1f * (float)(col + row);
  }
}

static int32_t scan_rows(dubsar_device* device, const dubsar_sink* sink, dubsar_error* error) {
  const int ragged = strcmp(device->mode, "ragged") == 0;
  const int points = strcmp(device->mode, "points") == 0;
  float x[COLS], y[COLS], z[COLS];
  uint8_t valid[COLS];
  dubsar_scan_info info;
  dubsar_scan_end end = {sizeof end, DUBSAR_OK, 0, 0, 0};
  if (strcmp(device->mode, "silent") == 0) {
    return DUBSAR_OK;
  }
  if (device->scans == 2) {
    return DUBSAR_END;
  }
  ++device->scans;
  memset(&info, 0, sizeof info);
  info.struct_size = sizeof info;
  info.flags = points ? DUBSAR_SCAN_UNORDERED : DUBSAR_SCAN_NOMINAL;
  info.cols = strcmp(device->mode, "cols") == 0 ? -5 : points ? 0 : COLS;
  info.view.struct_size = sizeof info.view;
  info.view.direction[2] = -1;
  info.tablet_from_scanner[0] = info.tablet_from_scanner[5] = cos(device->turntable_rad);
  info.tablet_from_scanner[1] = -(info.tablet_from_scanner[4] = sin(device->turntable_rad));
  info.tablet_from_scanner[10] = info.tablet_from_scanner[15] = 1;
  /* A shift along x, written row by row, or column by column as others have it. */
  info.tablet_from_scanner[strcmp(device->mode, "columns") == 0 ? 12 : 3] = 5;
  info.source = "odd scan";
  info.device_id = "odd 0815";
  static char long_name[3000001];
  if (strcmp(device->mode, "longwinded") == 0) {
    memset(long_name, 'n', sizeof long_name - 1);
    info.device_id = long_name;
  }
  if (strcmp(device->mode, "late") == 0) {
    dubsar_profile stray = {.struct_size = sizeof stray, .count = 0};
    sink->profile(sink->user, &stray);
    return DUBSAR_OK;
  }
  if (sink->begin(sink->user, &info) != 0) {
    return plain_cancelled(sink, &end, error);
  }
  const int burns = strcmp(device->mode, "burns") == 0;
  const int64_t rows = burns || strcmp(device->mode, "forever") == 0 ? INT64_MAX
                       : strcmp(device->mode, "empty") == 0          ? 0
                                                                     : ROWS;
  for (int64_t row = 0; row < rows; ++row) {
    dubsar_profile profile = {
        .struct_size = sizeof profile, .count = COLS, .row = row, .x = x, .y = y, .z = z};
    fill_row(x, y, z, row);
    if (strcmp(device->mode, "fail") == 0 && device->scans == 1 && row == 3) {
      sink->end(sink->user, &end);
      return plain_problem(error, DUBSAR_DEVICE, "the cable was pulled");
    }
    if (ragged) {
      memset(valid, 1, sizeof valid);
      profile.valid = valid;
      valid[2] = 0;
      if (row == 1) {
        profile.count = COLS - 3;
      } else if (row == 2) {
        x[0] = NAN;
        z[1] = INFINITY;
        y[3] = 1e30f;
      } else if (row == 3) {
        continue; /* lost */
      } else if (row == 5) {
        profile.row = 4; /* again */
      }
    }
    if (sink->profile(sink->user, &profile) != 0) {
      return plain_cancelled(sink, &end, error);
    }
    ++end.profiles_sent;
  }
  end.profiles_dropped = ragged ? 1 : 0;
  sink->end(sink->user, &end);
  return DUBSAR_OK;
}

static int32_t scan(dubsar_device* device, const dubsar_sink* sink, dubsar_error* error) {
  device->scanning = 1;
  const int32_t code = scan_rows(device, sink, error);
  device->scanning = 0;
  return code;
}

/* In the mode "burns" it is told while the scan runs, and has not obeyed when it is over. */
static int32_t stop(dubsar_device* device, dubsar_error* error) {
  return strcmp(device->mode, "burns") == 0 && !device->scanning
             ? plain_problem(error, DUBSAR_DEVICE, "the camera does not end its stream")
             : DUBSAR_OK;
}

const dubsar_driver* dubsar_driver_entry(void) {
  static const dubsar_driver driver = {
      .abi_version = DUBSAR_DRIVER_ABI_VERSION,
      .struct_size = sizeof(dubsar_driver),
      .scheme = "odd",
      .description = "a driver for tests",
      .version = "1",
      .locator_help = "anything",
      .describe_options = describe_options,
      .discover = discover,
      .open = open_device,
      .close = close_device,
      .capabilities = capabilities,
      .describe_settings = describe_settings,
      .get_setting = get_setting,
      .set_setting = set_setting,
      .place = place,
      .scan = scan,
      .stop = stop,
  };
  return &driver;
}
