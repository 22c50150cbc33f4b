trephine_test(meshio meshio)
