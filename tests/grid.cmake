trephine_test(grid grid)
