/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TREPHINE_VENDOR_LIBRARY_H
#define TREPHINE_VENDOR_LIBRARY_H
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What adaptors of a vendor's library share. Each is a library of its own, so all of it is static. */

static char failed[160] = "nothing failed";

/* One line of what failed, for trephine_adaptor_error(). */
static int fail(const char* what, const char* why) {
  snprintf(failed, sizeof failed, "%s%s%s", what, why && *why ? ": " : "", why && *why ? why : "");
  return 1;
}

/* Loads the vendor's library: the file that the environment variable names, else the first name that the loader finds.
 * NULL, with `failed` set, where there is none. */
static void* vendor_library(const char* variable, const char* const* names, const char* source) {
  const char* own = getenv(variable);
  if (own && *own) {
    void* found = dlopen(own, RTLD_NOW | RTLD_LOCAL);
    if (!found) snprintf(failed, sizeof failed, "%s of %s cannot be loaded; it comes with %s", own, variable, source);
    return found;
  }
  for (const char* const* name = names; *name; ++name) {
    void* found = dlopen(*name, RTLD_NOW | RTLD_LOCAL);
    if (found) return found;
  }
  snprintf(failed, sizeof failed, "%s is not installed: it comes with %s; %s names a file of it", names[0], source,
           variable);
  return NULL;
}

/* Sets *function to the library's function; 1, with `failed` set, where it has none. */
static int vendor_function(void* library, const char* name, void* function) {
  void* found = dlsym(library, name);
  if (!found) return fail("the vendor's library has no function", name);
  memcpy(function, &found, sizeof found); /* ISO C has no conversion from an object's to a function's pointer */
  return 0;
}
#endif
