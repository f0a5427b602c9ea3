message(FATAL_ERROR "penumbra included the host's install.cmake")
