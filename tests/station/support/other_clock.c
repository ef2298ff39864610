/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers
 *
 * A wall clock that is off by DUBSAR_CLOCK_OFF_S seconds, for programs that are started with this in
 * LD_PRELOAD. The clock that only runs forward is left alone, as it is when somebody sets the time. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <sys/time.h>
#include <time.h>

static long long off_s(void) {
  const char* text = getenv("DUBSAR_CLOCK_OFF_S");
  return text == NULL ? 0 : atoll(text);
}

int clock_gettime(clockid_t clock, struct timespec* out) {
  const int done = ((int (*)(clockid_t, struct timespec*))dlsym(RTLD_NEXT, "clock_gettime"))(clock, out);
  if (done == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) {
    out->tv_sec += (time_t)off_s();
  }
  return done;
}

time_t time(time_t* out) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (out != NULL) {
    *out = now.tv_sec;
  }
  return now.tv_sec;
}

int gettimeofday(struct timeval* restrict out, void* restrict zone) {
  struct timespec now;
  (void)zone;
  clock_gettime(CLOCK_REALTIME, &now);
  out->tv_sec = now.tv_sec;
  out->tv_usec = now.tv_nsec / 1000;
  return 0;
}
