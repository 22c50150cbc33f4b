/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loaded before the program (LD_PRELOAD): the graphics driver loses its context after some pictures, as it does when
 * the card hangs. libepoxy calls OpenGL through variables; this one stands before its own. */
static unsigned asked;

static unsigned reset_status(void) { return ++asked > 40 ? 0x8255u /* GL_UNKNOWN_CONTEXT_RESET */ : 0u; }

unsigned (*epoxy_glGetGraphicsResetStatus)(void) = reset_status;
