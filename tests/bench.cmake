# SPDX-License-Identifier: GPL-3.0-or-later
# bench/guard with stand-ins for the programs.
add_test(NAME bench.guard COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/guard.sh ${PROJECT_SOURCE_DIR})
