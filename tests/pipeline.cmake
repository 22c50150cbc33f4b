if(TARGET trephine_picture)
trephine_test(pipeline pipeline)
endif()
