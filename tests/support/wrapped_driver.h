/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */
#pragma once

#include <dlfcn.h>
#include <string.h>

#include "tests/support/plain_driver.h"

/* The driver in this library, NULL where there is none; and in `copy` one like it under another name, whose
 * functions may be replaced. */
static const dubsar_driver* wrap_driver(const char* library_path, const char* scheme, const char* description,
                                        dubsar_driver* copy) {
  typedef const dubsar_driver* (*entry)(void);
  void* library = dlopen(library_path, RTLD_NOW | RTLD_LOCAL);
  void* symbol = library != NULL ? dlsym(library, DUBSAR_DRIVER_ENTRY) : NULL;
  entry of_it = NULL;
  const dubsar_driver* wrapped = NULL;
  if (symbol == NULL) {
    return NULL;
  }
  memcpy(&of_it, &symbol, sizeof of_it);
  wrapped = of_it();
  memset(copy, 0, sizeof *copy);
  memcpy(copy, wrapped, wrapped->struct_size < sizeof *copy ? wrapped->struct_size : sizeof *copy);
  copy->struct_size = sizeof *copy;
  copy->scheme = scheme;
  copy->description = description;
  return wrapped;
}
