# SPDX-License-Identifier: GPL-3.0-or-later
trephine_test(cli cli)
target_link_libraries(cli_test PRIVATE nlohmann_json::nlohmann_json)
