/* SPDX-License-Identifier: Apache-2.0
 * Copyright The Dubsar developers
 *
 * A disk that refuses, for programs that are started with this in LD_PRELOAD. Every call that changes
 * something below DUBSAR_FAULT_ROOT is counted; the DUBSAR_FAULT_AT-th one meets DUBSAR_FAULT_DO: an errno by
 * name (ENOSPC, EIO, EROFS, EDQUOT)  the call fails so, and with DUBSAR_FAULT_STAYS=1 all later ones too KILL
 * the process is killed before the call KILL_AFTER                                     … after it KILL_HALF
 * … after half of the bytes of a write DUBSAR_FAULT_LOG is a file of at least 512 bytes that is shared with
 * the process: an int64 with the count of the calls, then the name and path of the call that met its fault.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

enum { kDescriptors = 4096, kLogBytes = 512, kCountBytes = 8 };
enum action { kPass, kFail, kKillBefore, kKillAfter, kKillHalf };

struct log {
  _Atomic int64_t count;
  char what[kLogBytes - kCountBytes];
};

static struct log* shared;
static const char* root;
static size_t root_length;
static int64_t fault_at;
static enum action fault;
static int fault_errno;
static int stays;
static _Atomic unsigned char below_root[kDescriptors];
static pthread_once_t once = PTHREAD_ONCE_INIT;

static void* real(const char* name) {
  return dlsym(RTLD_NEXT, name);
}

static void set_up(void) {
  static const struct {
    const char* name;
    enum action action;
    int number;
  } kActions[] = {{"ENOSPC", kFail, ENOSPC},  {"EIO", kFail, EIO},      {"EROFS", kFail, EROFS},
                  {"EDQUOT", kFail, EDQUOT},  {"KILL", kKillBefore, 0}, {"KILL_AFTER", kKillAfter, 0},
                  {"KILL_HALF", kKillHalf, 0}};
  const char* at = getenv("DUBSAR_FAULT_AT");
  const char* todo = getenv("DUBSAR_FAULT_DO");
  const char* file = getenv("DUBSAR_FAULT_LOG");
  const char* lasting = getenv("DUBSAR_FAULT_STAYS");
  root = getenv("DUBSAR_FAULT_ROOT");
  root_length = root == NULL ? 0 : strlen(root);
  fault_at = at == NULL ? 0 : atoll(at);
  stays = lasting != NULL && lasting[0] == '1';
  for (size_t i = 0; todo != NULL && i < sizeof kActions / sizeof kActions[0]; ++i) {
    if (strcmp(todo, kActions[i].name) == 0) {
      fault = kActions[i].action;
      fault_errno = kActions[i].number;
    }
  }
  if (file != NULL) {
    int (*open_really)(const char*, int, ...) = (int (*)(const char*, int, ...))real("open");
    const int fd = open_really(file, O_RDWR | O_CLOEXEC);
    void* at_memory = fd < 0 ? MAP_FAILED : mmap(NULL, kLogBytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (fd >= 0) {
      close(fd);
    }
    shared = at_memory == MAP_FAILED ? NULL : at_memory;
  }
}

static int concerns(const char* path) {
  pthread_once(&once, set_up);
  char whole[PATH_MAX];
  if (shared == NULL || root_length == 0 || path == NULL) {
    return 0;
  }
  if (path[0] != '/') {
    if (getcwd(whole, sizeof whole) == NULL || strlen(whole) + strlen(path) + 2 > sizeof whole) {
      return 0;
    }
    strcat(whole, "/");
    strcat(whole, path);
    path = whole;
  }
  return strncmp(path, root, root_length) == 0;
}

/* Counts a call and says what becomes of it. */
static enum action meet(const char* call, const char* path) {
  const int64_t number = atomic_fetch_add(&shared->count, 1) + 1;
  if (fault == kPass || fault_at <= 0 || number < fault_at ||
      (number > fault_at && !(stays && fault == kFail))) {
    return kPass;
  }
  if (number == fault_at) {
    snprintf(shared->what, sizeof shared->what, "%s %s", call, path == NULL ? "" : path);
  }
  if (fault == kKillBefore) {
    kill(getpid(), SIGKILL);
  }
  return fault;
}

static void after(enum action met) {
  if (met == kKillAfter || met == kKillHalf) {
    kill(getpid(), SIGKILL);
  }
}

static enum action meet_path(const char* call, const char* path) {
  return concerns(path) ? meet(call, path) : kPass;
}

static enum action meet_descriptor(const char* call, int fd) {
  pthread_once(&once, set_up);
  return shared != NULL && fd >= 0 && fd < kDescriptors && atomic_load(&below_root[fd]) != 0
             ? meet(call, NULL)
             : kPass;
}

/* Opening changes something when it may write; a folder is opened to be synced. */
static int opening(const char* name, const char* path, int flags, mode_t mode) {
  const int counts =
      ((flags & O_ACCMODE) != O_RDONLY || (flags & (O_CREAT | O_TRUNC)) != 0) && concerns(path);
  const enum action met = counts ? meet("open", path) : kPass;
  if (met == kFail) {
    errno = fault_errno;
    return -1;
  }
  int (*open_really)(const char*, int, ...) = (int (*)(const char*, int, ...))real(name);
  const int fd = open_really(path, flags, mode);
  if (fd >= 0 && fd < kDescriptors) {
    atomic_store(&below_root[fd], (unsigned char)(counts || ((flags & O_DIRECTORY) != 0 && concerns(path))));
  }
  after(met);
  return fd;
}

#define MODE_OF(flags)                            \
  mode_t mode = 0;                                \
  if (((flags) & (O_CREAT | __O_TMPFILE)) != 0) { \
    va_list rest;                                 \
    va_start(rest, flags);                        \
    mode = va_arg(rest, mode_t);                  \
    va_end(rest);                                 \
  }

int open(const char* path, int flags, ...) {
  MODE_OF(flags)
  return opening("open", path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  MODE_OF(flags)
  return opening("open64", path, flags, mode);
}

int close(int fd) {
  if (fd >= 0 && fd < kDescriptors) {
    atomic_store(&below_root[fd], 0);
  }
  return ((int (*)(int))real("close"))(fd);
}

/* Gives back -1 or goes on with `call`; a killed half write gets half of its bytes. */
#define FAIL_OR(met, call)      \
  if ((met) == kFail) {         \
    errno = fault_errno;        \
    return -1;                  \
  }                             \
  __typeof__(call) done = call; \
  after(met);                   \
  return done;

ssize_t write(int fd, const void* bytes, size_t count) {
  const enum action met = meet_descriptor("write", fd);
  FAIL_OR(met, ((ssize_t(*)(int, const void*, size_t))real("write"))(fd, bytes,
                                                                     met == kKillHalf ? count / 2 : count))
}

ssize_t pwrite(int fd, const void* bytes, size_t count, off_t at) {
  const enum action met = meet_descriptor("pwrite", fd);
  FAIL_OR(met, ((ssize_t(*)(int, const void*, size_t, off_t))real("pwrite"))(
                   fd, bytes, met == kKillHalf ? count / 2 : count, at))
}

ssize_t pwrite64(int fd, const void* bytes, size_t count, off_t at) {
  const enum action met = meet_descriptor("pwrite", fd);
  FAIL_OR(met, ((ssize_t(*)(int, const void*, size_t, off_t))real("pwrite64"))(
                   fd, bytes, met == kKillHalf ? count / 2 : count, at))
}

ssize_t writev(int fd, const struct iovec* parts, int count) {
  const enum action met = meet_descriptor("writev", fd);
  FAIL_OR(met, ((ssize_t(*)(int, const struct iovec*, int))real("writev"))(fd, parts,
                                                                           met == kKillHalf ? 1 : count))
}

int fsync(int fd) {
  const enum action met = meet_descriptor("fsync", fd);
  FAIL_OR(met, ((int (*)(int))real("fsync"))(fd))
}

int fdatasync(int fd) {
  const enum action met = meet_descriptor("fdatasync", fd);
  FAIL_OR(met, ((int (*)(int))real("fdatasync"))(fd))
}

int ftruncate(int fd, off_t length) {
  const enum action met = meet_descriptor("ftruncate", fd);
  FAIL_OR(met, ((int (*)(int, off_t))real("ftruncate"))(fd, length))
}

int ftruncate64(int fd, off_t length) {
  const enum action met = meet_descriptor("ftruncate", fd);
  FAIL_OR(met, ((int (*)(int, off_t))real("ftruncate64"))(fd, length))
}

int rename(const char* from, const char* to) {
  const enum action met = meet_path("rename", to);
  FAIL_OR(met, ((int (*)(const char*, const char*))real("rename"))(from, to))
}

int unlink(const char* path) {
  /* A full disk lets files go. */
  const int full = fault == kFail && (fault_errno == ENOSPC || fault_errno == EDQUOT);
  const enum action met = full ? kPass : meet_path("unlink", path);
  FAIL_OR(met, ((int (*)(const char*))real("unlink"))(path))
}

/* What std::filesystem::remove calls. */
int remove(const char* path) {
  const int full = fault == kFail && (fault_errno == ENOSPC || fault_errno == EDQUOT);
  const enum action met = full ? kPass : meet_path("remove", path);
  FAIL_OR(met, ((int (*)(const char*))real("remove"))(path))
}

int mkdir(const char* path, mode_t mode) {
  const enum action met = meet_path("mkdir", path);
  FAIL_OR(met, ((int (*)(const char*, mode_t))real("mkdir"))(path, mode))
}
