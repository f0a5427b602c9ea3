# How everything of penumbra is compiled: link penumbra_settings PRIVATE into each target.

set(CMAKE_C_STANDARD 17)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)

# A project that this one is a part of decides these for all of its parts.
if(PROJECT_IS_TOP_LEVEL)
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
endif()
if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "Release, RelWithDebInfo or Debug" FORCE)
endif()

add_library(penumbra_settings INTERFACE)
target_compile_options(penumbra_settings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes
  # The same input gives the same bits: no fused multiply-adds that depend on the target.
  -ffp-contract=off
  $<$<BOOL:${PENUMBRA_WERROR}>:-Werror>)
# -std=c17 hides POSIX and M_PI; this brings them back.
target_compile_definitions(penumbra_settings INTERFACE _DEFAULT_SOURCE)

if(PENUMBRA_SANITIZE)
  # Checks that the compiler adds make it see values that no run has; the other builds warn about the real ones.
  target_compile_options(penumbra_settings INTERFACE -Wno-format-truncation -Wno-maybe-uninitialized
                         -Wno-stringop-overflow)
  # For the whole tree, since a sanitizer's runtime must be in every executable.
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
  target_sources(penumbra_settings INTERFACE
    "$<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:${PROJECT_SOURCE_DIR}/cmake/sanitizers.c>")
  target_link_options(penumbra_settings INTERFACE
    "$<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:LINKER:--export-dynamic-symbol=dlclose>")
  set(PENUMBRA_LINK_OPTIONS "")
else()
  # A symbol that nothing defines is found here, not by the first program that loads the library.
  set(PENUMBRA_LINK_OPTIONS "LINKER:--no-undefined")
endif()
