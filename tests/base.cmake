trephine_test(base base)
