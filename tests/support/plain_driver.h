/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */
#ifndef DUBSAR_TESTS_PLAIN_DRIVER_H
#define DUBSAR_TESTS_PLAIN_DRIVER_H

/* What the drivers in plain C do alike that tests and benches bring along. */
#include <string.h>

#include "drivers/driver.h"

static inline int32_t plain_problem(dubsar_error* error, int32_t code, const char* what) {
  error->code = code;
  strncpy(error->what, what, sizeof error->what - 1);
  return code;
}

/* Ends the scan that began. */
static inline int32_t plain_cancelled(const dubsar_sink* sink, const dubsar_scan_end* end,
                                      dubsar_error* error) {
  sink->end(sink->user, end);
  return plain_problem(error, DUBSAR_CANCELLED, "cancelled");
}

static inline int32_t plain_no_options(dubsar_setting_callback callback, void* user, dubsar_error* error) {
  (void)callback;
  (void)user;
  (void)error;
  return DUBSAR_OK;
}

static inline int32_t plain_one_device(dubsar_device_callback callback, void* user, const char* uri,
                                       const char* label) {
  const dubsar_device_info info = {sizeof info, uri, label};
  return callback(user, &info) != 0 ? DUBSAR_CANCELLED : DUBSAR_OK;
}

/* No more than the caller has room for. */
static inline int32_t plain_give_capabilities(const dubsar_capabilities* filled, dubsar_capabilities* out) {
  memcpy(out, filled, out->struct_size < sizeof *filled ? out->struct_size : sizeof *filled);
  return DUBSAR_OK;
}

/* What a scanner can do that moves nothing and has no end. */
static inline int32_t plain_capabilities(uint32_t flags, const char* serial, dubsar_capabilities* out) {
  dubsar_capabilities filled;
  memset(&filled, 0, sizeof filled);
  filled.struct_size = out->struct_size;
  filled.flags = flags;
  filled.scan_count = -1;
  filled.calibration_age_days = -1;
  strcpy(filled.serial, serial);
  return plain_give_capabilities(&filled, out);
}

static inline int32_t plain_describe(const dubsar_setting* settings, size_t count,
                                     dubsar_setting_callback callback, void* user) {
  for (size_t i = 0; i < count; ++i) {
    if (callback(user, &settings[i]) != 0) {
      return DUBSAR_CANCELLED;
    }
  }
  return DUBSAR_OK;
}

/* A scan that looks straight down. */
static inline dubsar_scan_info plain_scan_info(int32_t cols, double spacing_mm, const char* device_id) {
  dubsar_scan_info info;
  memset(&info, 0, sizeof info);
  info.struct_size = sizeof info;
  info.cols = cols;
  info.spacing_mm = spacing_mm;
  info.view.struct_size = sizeof info.view;
  info.view.direction[2] = -1;
  info.device_id = device_id;
  return info;
}

#endif
