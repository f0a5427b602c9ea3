# cmake -DFROM=... -DTO=... "-DNAMES=..." -P add_lines.cmake: TO is FROM with a line for each technique at its end.
file(READ "${FROM}" text)
separate_arguments(NAMES)
foreach(name IN LISTS NAMES)
  string(APPEND text "PNI_TECHNIQUE(${name})\n")
endforeach()
file(WRITE "${TO}" "${text}")
