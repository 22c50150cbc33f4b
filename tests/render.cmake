# SPDX-License-Identifier: GPL-3.0-or-later
# Pictures of the simulator, drawn without a display by Mesa's llvmpipe with one thread.
if(TARGET trephine_render)
trephine_test(render render picture)
endif()
