/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */

/* A driver of before arms: its structs end where they ended then, and it minds that nobody goes beyond. */
#include <stddef.h>
#include <string.h>

#include "drivers/driver.h"

struct dubsar_device {
  int unused;
};
static struct dubsar_device the_device;

static int32_t describe_options(dubsar_setting_callback callback, void* user, dubsar_error* error) {
  (void)callback, (void)user, (void)error;
  return DUBSAR_OK;
}
static int32_t discover(dubsar_device_callback callback, void* user, dubsar_error* error) {
  (void)callback, (void)user, (void)error;
  return DUBSAR_OK;
}
static int32_t open_device(const char* locator, const dubsar_option* options, uint32_t count,
                           dubsar_device** device, dubsar_error* error) {
  (void)locator, (void)options, (void)count, (void)error;
  *device = &the_device;
  return DUBSAR_OK;
}
static void close_device(dubsar_device* device) {
  (void)device;
}
static int32_t capabilities(dubsar_device* device, dubsar_capabilities* out, dubsar_error* error) {
  dubsar_capabilities mine;
  (void)device, (void)error;
  memset(&mine, 0, sizeof mine);
  mine.struct_size = offsetof(dubsar_capabilities, turntable_min_rad);
  mine.flags = DUBSAR_HAS_RIG | DUBSAR_HAS_TURNTABLE;
  mine.scan_count = -1;
  mine.spacing_mm = mine.field_x_mm = mine.field_y_mm = mine.depth_range_mm = 10;
  memcpy(out, &mine, mine.struct_size);
  return DUBSAR_OK;
}
static int32_t place(dubsar_device* device, const dubsar_placement* placement, dubsar_error* error) {
  (void)device, (void)error;
  return placement->struct_size >= offsetof(dubsar_placement, has_free_pose) ? DUBSAR_OK : DUBSAR_INTERNAL;
}
static int32_t scan(dubsar_device* device, const dubsar_sink* sink, dubsar_error* error) {
  (void)device, (void)sink, (void)error;
  return DUBSAR_END;
}
static int32_t never(dubsar_device* device, dubsar_error* error) {
  (void)device, (void)error;
  return DUBSAR_INTERNAL;
}

const dubsar_driver* dubsar_driver_entry(void) {
  static const dubsar_driver driver = {.abi_version = DUBSAR_DRIVER_ABI_VERSION,
                                       .struct_size = offsetof(dubsar_driver, stop),
                                       .scheme = "old",
                                       .description = "",
                                       .version = "1",
                                       .locator_help = "",
                                       .describe_options = describe_options,
                                       .discover = discover,
                                       .open = open_device,
                                       .close = close_device,
                                       .capabilities = capabilities,
                                       .place = place,
                                       .scan = scan,
                                       .stop = never}; /* beyond struct_size: nobody looks at it */
  return &driver;
}
