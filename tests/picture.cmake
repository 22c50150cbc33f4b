trephine_test(picture picture)
