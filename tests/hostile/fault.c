/* SPDX-License-Identifier: BSD-3-Clause */
/* A library to preload that makes one call to the system go wrong among those that change files below a
 * folder.
 *
 * FAULT_BELOW  the folder, an absolute path without links
 * FAULT_AT     which call, counted from 1
 * FAULT_MODE   once: this call fails; on: so does every later one; short: it writes half of its bytes and
 * succeeds; kill: the process is killed before it; tear: it writes half of its bytes, and the process is
 * killed FAULT_ERROR  errno of the calls that fail FAULT_COUNT  file of 8 bytes that receives the number of
 * calls, readable however the process ends
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

enum mode { none, once, on, cut_short, die, tear };

static char below[PATH_MAX];
static size_t below_length;
static long at;
static int error;
static enum mode mode;
static _Atomic long* count;

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

static enum mode mode_of(const char* name) {
  static const char* const names[] = {"none", "once", "on", "short", "kill", "tear"};
  for (int k = 0; name != NULL && k <= tear; ++k)
    if (strcmp(name, names[k]) == 0) return (enum mode)k;
  return none;
}

static long number(const char* name) {
  const char* text = getenv(name);
  return text == NULL ? 0 : strtol(text, NULL, 10);
}

__attribute__((constructor)) static void begin(void) {
  static _Atomic long own_count;
  count = &own_count;
  const char* folder = getenv("FAULT_BELOW");
  if (folder == NULL) return;
  below_length = strlen(folder);
  if (below_length >= sizeof(below)) abort();
  memcpy(below, folder, below_length + 1);
  at = number("FAULT_AT");
  error = (int)number("FAULT_ERROR");
  mode = mode_of(getenv("FAULT_MODE"));
  const char* file = getenv("FAULT_COUNT");
  if (file == NULL) return;
  const int fd = REAL(open)(file, O_RDWR);
  if (fd < 0) abort();
  count = mmap(NULL, sizeof(*count), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (count == MAP_FAILED) abort();
  REAL(close)(fd);
}

static bool is_below(const char* path) {
  return below_length > 0 && strncmp(path, below, below_length) == 0 &&
         (path[below_length] == '/' || path[below_length] == '\0');
}

static bool path_is_ours(const char* path) {
  char whole[2 * PATH_MAX];
  if (path[0] == '/') return is_below(path);
  if (getcwd(whole, PATH_MAX) == NULL) return false;
  const size_t length = strlen(whole);
  snprintf(whole + length, sizeof(whole) - length, "/%s", path);
  return is_below(whole);
}

static bool fd_is_ours(int fd) {
  char link[64], path[PATH_MAX];
  snprintf(link, sizeof(link), "/proc/self/fd/%d", fd);
  const ssize_t length = readlink(link, path, sizeof(path) - 1);
  if (length < 0) return false;
  path[length] = '\0';
  return is_below(path);
}

static bool at_is_ours(int folder, const char* path) {
  return path[0] == '/' || folder == AT_FDCWD ? path_is_ours(path) : fd_is_ours(folder);
}

static bool writes(int flags) {
  return (flags & O_ACCMODE) != O_RDONLY || (flags & O_CREAT) != 0;
}

static bool fd_is_written(int fd) {
  const int flags = fcntl(fd, F_GETFL);
  return flags >= 0 && writes(flags) && fd_is_ours(fd);
}

/* Counts a call. Returns whether it is to fail. */
static bool fails(void) {
  const long n = atomic_fetch_add(count, 1) + 1;
  if (n == at && mode == die) raise(SIGKILL);
  if ((n == at && mode == once) || (n >= at && mode == on)) {
    errno = error;
    return true;
  }
  return false;
}

/* The same for a call that writes. `bytes` becomes less where the call is to be cut short. */
static bool write_fails(size_t* bytes, bool* torn) {
  const bool now = atomic_load(count) + 1 == at;
  *torn = now && mode == tear;
  if (now && (mode == cut_short || mode == tear) && *bytes > 1) *bytes /= 2;
  return fails();
}

static ssize_t end_of_write(ssize_t written, bool torn) {
  if (torn) raise(SIGKILL);
  return written;
}

#define OPEN(name)                                                 \
  int name(const char* path, int flags, ...) {                     \
    va_list rest;                                                  \
    va_start(rest, flags);                                         \
    const mode_t bits = va_arg(rest, mode_t);                      \
    va_end(rest);                                                  \
    if (writes(flags) && path_is_ours(path) && fails()) return -1; \
    return REAL(name)(path, flags, bits);                          \
  }
OPEN(open)
OPEN(open64)

#define OPENAT(name)                                                     \
  int name(int folder, const char* path, int flags, ...) {               \
    va_list rest;                                                        \
    va_start(rest, flags);                                               \
    const mode_t bits = va_arg(rest, mode_t);                            \
    va_end(rest);                                                        \
    if (writes(flags) && at_is_ours(folder, path) && fails()) return -1; \
    return REAL(name)(folder, path, flags, bits);                        \
  }
OPENAT(openat)
OPENAT(openat64)

ssize_t write(int fd, const void* data, size_t bytes) {
  bool torn = false;
  if (fd_is_ours(fd) && write_fails(&bytes, &torn)) return -1;
  return end_of_write(REAL(write)(fd, data, bytes), torn);
}

ssize_t writev(int fd, const struct iovec* pieces, int n) {
  size_t bytes = 0;
  bool torn = false;
  if (fd_is_ours(fd) && write_fails(&bytes, &torn)) return -1;
  return end_of_write(REAL(writev)(fd, pieces, n), torn);
}

#define PWRITE(name)                                                   \
  ssize_t name(int fd, const void* data, size_t bytes, off_t offset) { \
    bool torn = false;                                                 \
    if (fd_is_ours(fd) && write_fails(&bytes, &torn)) return -1;       \
    return end_of_write(REAL(name)(fd, data, bytes, offset), torn);    \
  }
PWRITE(pwrite)
PWRITE(pwrite64)

int close(int fd) {
  const bool failed = fd_is_written(fd) && fails();
  const int kept = errno;
  const int result = REAL(close)(fd); /* Linux releases the number in any case */
  if (!failed) return result;
  errno = kept;
  return -1;
}

int fsync(int fd) {
  return fd_is_ours(fd) && fails() ? -1 : REAL(fsync)(fd);
}
int fdatasync(int fd) {
  return fd_is_ours(fd) && fails() ? -1 : REAL(fdatasync)(fd);
}
int ftruncate(int fd, off_t length) {
  return fd_is_ours(fd) && fails() ? -1 : REAL(ftruncate)(fd, length);
}
int ftruncate64(int fd, off_t length) {
  return fd_is_ours(fd) && fails() ? -1 : REAL(ftruncate64)(fd, length);
}

int fallocate(int fd, int how, off_t from, off_t length) {
  return fd_is_ours(fd) && fails() ? -1 : REAL(fallocate)(fd, how, from, length);
}
int fallocate64(int fd, int how, off64_t from, off64_t length) {
  return fd_is_ours(fd) && fails() ? -1 : REAL(fallocate64)(fd, how, from, length);
}

int rename(const char* from, const char* to) {
  return (path_is_ours(from) || path_is_ours(to)) && fails() ? -1 : REAL(rename)(from, to);
}
int mkdir(const char* path, mode_t bits) {
  return path_is_ours(path) && fails() ? -1 : REAL(mkdir)(path, bits);
}
int unlink(const char* path) {
  return path_is_ours(path) && fails() ? -1 : REAL(unlink)(path);
}
int unlinkat(int folder, const char* path, int flags) {
  return at_is_ours(folder, path) && fails() ? -1 : REAL(unlinkat)(folder, path, flags);
}
int rmdir(const char* path) {
  return path_is_ours(path) && fails() ? -1 : REAL(rmdir)(path);
}
int remove(const char* path) {
  return path_is_ours(path) && fails() ? -1 : REAL(remove)(path);
}
