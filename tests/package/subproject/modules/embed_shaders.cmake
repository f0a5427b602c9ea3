message(FATAL_ERROR "penumbra included the host's embed_shaders.cmake")
