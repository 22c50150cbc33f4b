trephine_test(metrics metrics)
