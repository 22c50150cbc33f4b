trephine_test(cases cases)
