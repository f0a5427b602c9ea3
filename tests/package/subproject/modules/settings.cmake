message(FATAL_ERROR "penumbra included the host's settings.cmake")
