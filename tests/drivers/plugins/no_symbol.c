/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers */
int something_else(void);
int something_else(void) {
  return 7;
}
