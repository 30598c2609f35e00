/* SPDX-License-Identifier: BSD-3-Clause */
/* A library to preload that makes one call to the system go wrong among those that change files below a
 * folder.
 *
 * FAULT_BELOW  the folder, an absolute path without links
 * FAULT_AT     which call, counted from 1
 * FAULT_MODE   once: this call fails; on: so does every later one; short: it writes half of its bytes and
 *              succeeds; kill: the process is killed before it; tear: it writes half of its bytes, and the
 *              process is killed; power: before it the power fails, so that files lose what was written to
 *              them since they were last synchronised
 * FAULT_ERROR  errno of the calls that fail
 * FAULT_COUNT  file of 8 bytes that receives the number of calls, readable however the process ends
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
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

enum mode { none, once, on, cut_short, die, tear, power };

static char below[PATH_MAX];
static size_t below_length;
static long at;
static int error;
static enum mode mode;
static _Atomic long* count;

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

static enum mode mode_of(const char* name) {
  static const char* const names[] = {"none", "once", "on", "short", "kill", "tear", "power"};
  for (int k = 0; name != NULL && k <= power; ++k)
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

/* The files that were written to, and their lengths when they were last synchronised. */
static struct {
  dev_t device;
  ino_t inode;
  int fd; /* opened anew, without the locks of the other: it outlives close, rename and unlink */
  off_t safe_length;
} written[256];
static int n_written;
static pthread_mutex_t written_mutex = PTHREAD_MUTEX_INITIALIZER;

/* To be called before a write, and after the file was synchronised. */
static void note_file(int fd, bool synchronised) {
  struct stat file;
  if (mode != power || fstat(fd, &file) != 0 || !S_ISREG(file.st_mode)) return;
  pthread_mutex_lock(&written_mutex);
  int k = 0;
  while (k < n_written && (written[k].device != file.st_dev || written[k].inode != file.st_ino)) ++k;
  if (k == n_written) {
    if (n_written == sizeof(written) / sizeof(*written)) abort();
    ++n_written;
    written[k].device = file.st_dev;
    written[k].inode = file.st_ino;
    char link[64];
    snprintf(link, sizeof(link), "/proc/self/fd/%d", fd);
    written[k].fd = REAL(open)(link, O_RDWR | O_CLOEXEC);
    written[k].safe_length = file.st_size;
  } else if (synchronised) {
    written[k].safe_length = file.st_size;
  }
  pthread_mutex_unlock(&written_mutex);
}

static void lose_power(void) {
  pthread_mutex_lock(&written_mutex);
  for (int k = 0; k < n_written; ++k)
    if (REAL(ftruncate)(written[k].fd, written[k].safe_length) != 0) abort();
  raise(SIGKILL);
}

/* Counts a call. Returns whether it is to fail. */
static bool fails(void) {
  const long n = atomic_fetch_add(count, 1) + 1;
  if (n == at && mode == die) raise(SIGKILL);
  if (n == at && mode == power) lose_power();
  if ((n == at && mode == once) || (n >= at && mode == on)) {
    errno = error;
    return true;
  }
  return false;
}

/* The same for a call that writes. `bytes` becomes less where the call is to be cut short. */
static bool write_fails(int fd, size_t* bytes, bool* torn) {
  note_file(fd, false);
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
  if (fd_is_ours(fd) && write_fails(fd, &bytes, &torn)) return -1;
  return end_of_write(REAL(write)(fd, data, bytes), torn);
}

ssize_t writev(int fd, const struct iovec* pieces, int n) {
  size_t bytes = 0;
  bool torn = false;
  if (fd_is_ours(fd) && write_fails(fd, &bytes, &torn)) return -1;
  return end_of_write(REAL(writev)(fd, pieces, n), torn);
}

#define PWRITE(name)                                                   \
  ssize_t name(int fd, const void* data, size_t bytes, off_t offset) { \
    bool torn = false;                                                 \
    if (fd_is_ours(fd) && write_fails(fd, &bytes, &torn)) return -1;   \
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

static int end_of_sync(int fd, int result) {
  if (result == 0 && fd_is_ours(fd)) note_file(fd, true);
  return result;
}
int fsync(int fd) {
  return fd_is_ours(fd) && fails() ? -1 : end_of_sync(fd, REAL(fsync)(fd));
}
int fdatasync(int fd) {
  return fd_is_ours(fd) && fails() ? -1 : end_of_sync(fd, REAL(fdatasync)(fd));
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
int renameat(int from_folder, const char* from, int to_folder, const char* to) {
  return (at_is_ours(from_folder, from) || at_is_ours(to_folder, to)) && fails()
             ? -1
             : REAL(renameat)(from_folder, from, to_folder, to);
}
int mkdirat(int folder, const char* path, mode_t bits) {
  return at_is_ours(folder, path) && fails() ? -1 : REAL(mkdirat)(folder, path, bits);
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
