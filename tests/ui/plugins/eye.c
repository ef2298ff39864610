/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */

/* A scanner in plain C whose camera can be looked through: a stripe across the frame, as bright as the
 * setting exposure_us makes it, and a bumpy field for its scans, one for each that is asked for. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/plain_driver.h"

enum { WIDTH = 320, HEIGHT = 200, COLS = 120, ROWS = 100 };

struct dubsar_device {
  double exposure_us;
  int64_t flip;
  char trigger[16];
  int runs;
  uint64_t frames;
  uint8_t pixels[WIDTH * HEIGHT];
};

static int32_t discover(dubsar_device_callback callback, void* user, dubsar_error* error) {
  (void)error;
  return plain_one_device(callback, user, "eye:", "an eye");
}

static int32_t open_device(const char* locator, const dubsar_option* options, uint32_t count,
                           dubsar_device** device, dubsar_error* error) {
  (void)locator;
  (void)options;
  (void)count;
  *device = calloc(1, sizeof **device);
  if (*device == NULL) {
    return plain_problem(error, DUBSAR_INTERNAL, "no memory");
  }
  (*device)->exposure_us = 5000;
  strcpy((*device)->trigger, "free");
  return DUBSAR_OK;
}

static void close_device(dubsar_device* device) {
  free(device);
}

static int32_t capabilities(dubsar_device* device, dubsar_capabilities* out, dubsar_error* error) {
  (void)device;
  (void)error;
  return plain_capabilities(DUBSAR_YIELDS_FRAMES, "EYE-1", out);
}

static int32_t describe_settings(dubsar_device* device, dubsar_setting_callback callback, void* user,
                                 dubsar_error* error) {
  const dubsar_setting settings[] = {
      {sizeof(dubsar_setting), DUBSAR_TYPE_NUMBER, 3, "exposure_us", "time that a frame is exposed", "us",
       NULL, 10, 20000, 0},
      {sizeof(dubsar_setting), DUBSAR_TYPE_BOOL, 3, "flip", "upside down", NULL, NULL, 1, 0, 0},
      {sizeof(dubsar_setting), DUBSAR_TYPE_CHOICE, 3, "trigger", "what releases a frame", NULL,
       "free|encoder", 1, 0, 0},
      {sizeof(dubsar_setting), DUBSAR_TYPE_INTEGER, 1, "width_px", "of a frame", "px", NULL, 1, 0, 0},
  };
  (void)device;
  (void)error;
  return plain_describe(settings, sizeof settings / sizeof settings[0], callback, user);
}

static int32_t get_setting(dubsar_device* device, const char* key, dubsar_value* value, dubsar_error* error) {
  (void)error;
  if (strcmp(key, "exposure_us") == 0) {
    value->number = device->exposure_us;
  } else if (strcmp(key, "flip") == 0) {
    value->integer = device->flip;
  } else if (strcmp(key, "trigger") == 0) {
    strcpy(value->text, device->trigger);
  } else {
    value->integer = WIDTH;
  }
  return DUBSAR_OK;
}

static int32_t set_setting(dubsar_device* device, const char* key, const dubsar_value* value,
                           dubsar_error* error) {
  if (strcmp(key, "flip") == 0 && device->runs) {
    return plain_problem(error, DUBSAR_USAGE, "flip cannot change while frames run");
  }
  if (strcmp(key, "exposure_us") == 0) {
    device->exposure_us = value->number;
  } else if (strcmp(key, "flip") == 0) {
    device->flip = value->integer;
  } else {
    strncpy(device->trigger, value->text, sizeof device->trigger - 1);
  }
  return DUBSAR_OK;
}

static int32_t start_frames(dubsar_device* device, uint32_t pool, dubsar_error* error) {
  (void)pool;
  (void)error;
  device->runs = 1;
  return DUBSAR_OK;
}

static int32_t next_frame(dubsar_device* device, uint32_t timeout_ms, dubsar_frame* frame,
                          dubsar_error* error) {
  dubsar_frame filled;
  (void)timeout_ms;
  if (!device->runs) {
    return plain_problem(error, DUBSAR_USAGE, "the stream was not started");
  }
  for (int u = 0; u < WIDTH; ++u) {
    const double middle = 90 + 0.05 * u;
    const double tall = 250 * device->exposure_us / 5000 * (0.6 + 0.39 * sin(u * 0.05));
    for (int v = 0; v < HEIGHT; ++v) {
      const double off = (v - middle) / 3;
      const double grey = 4 + tall * exp(-0.5 * off * off);
      const int row = device->flip ? HEIGHT - 1 - v : v;
      device->pixels[row * WIDTH + u] = (uint8_t)(grey > 255 ? 255 : grey);
    }
  }
  memset(&filled, 0, sizeof filled);
  filled.struct_size = frame->struct_size;
  filled.id = filled.lease = ++device->frames;
  filled.timestamp_ns = (int64_t)device->frames;
  filled.pixels = device->pixels;
  filled.size_bytes = sizeof device->pixels;
  filled.width = filled.stride_bytes = WIDTH;
  filled.height = HEIGHT;
  filled.pixel_format = DUBSAR_PIXEL_MONO8;
  memcpy(frame, &filled, frame->struct_size < sizeof filled ? frame->struct_size : sizeof filled);
  return DUBSAR_OK;
}

static void release_frame(dubsar_device* device, uint64_t lease) {
  (void)device;
  (void)lease;
}

static int32_t stop_frames(dubsar_device* device, dubsar_error* error) {
  (void)error;
  device->runs = 0;
  return DUBSAR_OK;
}

static int32_t frame_counters(dubsar_device* device, dubsar_frame_counters* counters, dubsar_error* error) {
  (void)error;
  counters->delivered = device->frames;
  return DUBSAR_OK;
}

static int32_t scan(dubsar_device* device, const dubsar_sink* sink, dubsar_error* error) {
  float x[COLS], y[COLS], z[COLS];
  const dubsar_scan_info info = plain_scan_info(COLS, 0.2, "eye EYE-1");
  dubsar_scan_end end = {sizeof end, DUBSAR_OK, 0, 0, 0};
  if (device->runs) {
    return plain_problem(error, DUBSAR_DEVICE, "the camera is being looked through");
  }
  if (sink->begin(sink->user, &info) != 0) {
    return plain_cancelled(sink, &end, error);
  }
  for (int64_t row = 0; row < ROWS; ++row) {
    const dubsar_profile profile = {
        .struct_size = sizeof profile, .count = COLS, .row = row, .x = x, .y = y, .z = z};
    for (int col = 0; col < COLS; ++col) {
      x[col] = 0.2f * (float)col;
      y[col] = 0.2f * (float)row;
      z[col] = 0.4f * sinf(0.9f * x[col]) * cosf(1.3f * y[col]) + 0.3f * sinf(0.31f * x[col] * y[col]);
    }
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
      .scheme = "eye",
      .description = "a scanner for tests whose camera can be looked through",
      .version = "1",
      .locator_help = "",
      .describe_options = plain_no_options,
      .discover = discover,
      .open = open_device,
      .close = close_device,
      .capabilities = capabilities,
      .describe_settings = describe_settings,
      .get_setting = get_setting,
      .set_setting = set_setting,
      .scan = scan,
      .start_frames = start_frames,
      .next_frame = next_frame,
      .release_frame = release_frame,
      .stop_frames = stop_frames,
      .frame_counters = frame_counters,
  };
  return &driver;
}
