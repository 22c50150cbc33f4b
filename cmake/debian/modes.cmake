# SPDX-License-Identifier: GPL-3.0-or-later
# Read by cpack before it packs: folders that it made have the mode that its umask left of 755.
file(CHMOD_RECURSE "${CPACK_TEMPORARY_DIRECTORY}" DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE
     GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
