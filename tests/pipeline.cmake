trephine_test(pipeline pipeline)
