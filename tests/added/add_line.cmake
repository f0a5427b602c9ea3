# cmake -DFROM=... -DTO=... -DLINE=... -P add_line.cmake: TO is FROM with the line at its end.
file(READ "${FROM}" text)
file(WRITE "${TO}" "${text}${LINE}\n")
