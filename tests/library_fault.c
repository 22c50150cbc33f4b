// SPDX-License-Identifier: GPL-3.0-or-later
// Loaded by LD_PRELOAD: the n-th call of one function fails, in programs whose command line holds a word.
//   TREPHINE_FAULT=write:3:28    the third write to a file of a folder (no memfd) fails with errno 28 (ENOSPC); short:3 writes one byte
//   TREPHINE_FAULT=write+:3:28   it and all that follow
//   TREPHINE_FAULT=signal:3:11    the third allocation of 4 KB and more sends the program itself signal 11 (SIGSEGV)
//   TREPHINE_FAULT_IN=run        only where an argument is this word, or one of the words that trephine @3 reads
//   TREPHINE_FAULT_COUNT=FILE    no call fails; the number of calls is appended to the file at the end
// Nothing fails before main. Functions: write (and short), fsync, rename, open (of files to be made), close (of files that were written), malloc (of
// 4 KB and more).
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static atomic_long calls;
static long wanted;
static int error_number, onwards, chosen, active;
static char kind[16];

static void* next(const char* name) { return dlsym(RTLD_NEXT, name); }

__attribute__((constructor)) static void begin(void) {
  const char* fault = getenv("TREPHINE_FAULT");
  if (!fault) return;
  const char* word = getenv("TREPHINE_FAULT_IN");
  char line[8192];
  const int fd = open("/proc/self/cmdline", O_RDONLY);
  const ssize_t n = fd >= 0 ? read(fd, line, sizeof line - 1) : 0;
  if (fd >= 0) close(fd);
  if (n <= 0) return;
  line[n] = 0;
  int found = !word;
  for (ssize_t i = 0; word && i < n; i += (ssize_t)strlen(line + i) + 1)
    if (strcmp(line + i, word) == 0) found = 1;
  // A library's jobs read their words from a file without a name: trephine @3.
  const char* second = line + strlen(line) + 1;
  if (!found && second < line + n && second[0] == '@') {
    const ssize_t m = pread(atoi(second + 1), line, sizeof line - 1, 0);
    if (m > 0) line[m] = 0;
    for (ssize_t i = 0; i < m; i += (ssize_t)strlen(line + i) + 1)
      if (strcmp(line + i, word) == 0) found = 1;
  }
  if (!found) return;
  char name[16] = "";
  if (sscanf(fault, "%15[^:]:%ld:%d", name, &wanted, &error_number) < 2) return;
  const size_t length = strlen(name);
  if (length > 0 && name[length - 1] == '+') onwards = 1, name[length - 1] = 0;
  strcpy(kind, name);
  chosen = 1;
}

static int (*real_main)(int, char**, char**);
static int our_main(int argc, char** argv, char** environment) {
  active = chosen;
  return real_main(argc, argv, environment);
}
int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(void), void (*fini)(void),
                      void (*rtld_fini)(void), void* stack_end) {
  int (*real)(int (*)(int, char**, char**), int, char**, void (*)(void), void (*)(void), void (*)(void), void*) =
      next("__libc_start_main");
  real_main = main;
  return real(our_main, argc, argv, init, fini, rtld_fini, stack_end);
}

__attribute__((destructor)) static void end(void) {
  const char* file = getenv("TREPHINE_FAULT_COUNT");
  if (!file || !active) return;
  active = 0;
  FILE* f = fopen(file, "a");
  if (f) fprintf(f, "%ld\n", atomic_load(&calls)), fclose(f);
}

static int fails(const char* name) {
  if (!active || strcmp(kind, name) != 0) return 0;
  const long n = atomic_fetch_add(&calls, 1) + 1;
  if (getenv("TREPHINE_FAULT_COUNT")) return 0;
  if (n != wanted && !(onwards && n > wanted)) return 0;
  errno = error_number;
  return 1;
}

static int is_written_file(int fd) {
  struct stat s;
  const int kept = errno, flags = fcntl(fd, F_GETFL);
  const int is = fstat(fd, &s) == 0 && S_ISREG(s.st_mode) && s.st_nlink > 0 && flags >= 0 && (flags & O_ACCMODE) != O_RDONLY;
  errno = kept;
  return is;
}

ssize_t write(int fd, const void* data, size_t size) {
  static ssize_t (*real)(int, const void*, size_t);
  if (!real) real = next("write");
  if (active && fd > 2 && is_written_file(fd)) {
    if (fails("write")) return -1;
    if (size > 1 && fails("short")) size = 1;
  }
  return real(fd, data, size);
}
int fsync(int fd) {
  static int (*real)(int);
  if (!real) real = next("fsync");
  return fails("fsync") ? -1 : real(fd);
}
int rename(const char* from, const char* to) {
  static int (*real)(const char*, const char*);
  if (!real) real = next("rename");
  return fails("rename") ? -1 : real(from, to);
}
int close(int fd) {
  static int (*real)(int);
  if (!real) real = next("close");
  if (active && fd > 2 && is_written_file(fd) && fails("close")) {
    const int kept = errno;
    real(fd);
    errno = kept;
    return -1;
  }
  return real(fd);
}
int open(const char* path, int flags, ...) {
  static int (*real)(const char*, int, ...);
  if (!real) real = next("open");
  va_list rest;
  va_start(rest, flags);
  const int mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, int) : 0;
  va_end(rest);
  if ((flags & O_CREAT) && fails("open")) return -1;
  return real(path, flags, mode);
}
void* malloc(size_t size) {
  static void* (*real)(size_t);
  static __thread int within;
  if (!real) {
    if (within) return NULL;
    within = 1;
    real = next("malloc");
    within = 0;
  }
  if (active && size >= 4096 && fails("signal")) kill(getpid(), error_number);
  if (active && size >= 4096 && fails("malloc")) {
    errno = ENOMEM;
    return NULL;
  }
  return real(size);
}
