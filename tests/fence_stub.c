/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loaded before the program (LD_PRELOAD): llvmpipe's thread takes its time to unlock a mutex, as on a busy machine. It
 * says at the end how many unlocks it delayed, and how many mutexes were destroyed meanwhile, which the thread would
 * have written to after they were freed (simulator/render/kept_fences.h). */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <unistd.h>

typedef int (*Call)(pthread_mutex_t*);
static _Atomic(Call) unlock_, destroy_;
static _Atomic(pthread_mutex_t*) held;
static atomic_int delayed, destroyed;

static Call next(_Atomic(Call)* call, const char* name) {
  if (!*call) *call = (Call)dlsym(RTLD_NEXT, name);
  return *call;
}

int pthread_mutex_unlock(pthread_mutex_t* mutex) {
  const Call unlock = next(&unlock_, "pthread_mutex_unlock");
  char thread[17] = "";
  prctl(PR_GET_NAME, thread);
  if (strcmp(thread, "llvmpipe-0") != 0) return unlock(mutex);
  held = mutex;
  usleep((unsigned)(++delayed * 797 % 3000));
  held = NULL;
  return unlock(mutex);
}

int pthread_mutex_destroy(pthread_mutex_t* mutex) {
  if (mutex == held) ++destroyed;
  return next(&destroy_, "pthread_mutex_destroy")(mutex);
}

__attribute__((destructor)) static void say(void) {
  if (delayed > 0) fprintf(stderr, "%d unlocks were slow, %d mutexes were destroyed meanwhile\n", delayed, destroyed);
}
