# Installs into a tree, moves it, and builds the consumer against it in four ways.
set(root "${WORK}/moved")
include("${CMAKE_CURRENT_LIST_DIR}/quietly.cmake")

file(REMOVE_RECURSE "${WORK}")
file(MAKE_DIRECTORY "${WORK}")
run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${WORK}/installed")
file(RENAME "${WORK}/installed" "${root}") # the package files name no place of their own

function(run_consumer program)
  execute_process(COMMAND "${CMAKE_COMMAND}" -E env "LD_LIBRARY_PATH=${root}/${LIBDIR}" "${program}"
                  OUTPUT_VARIABLE output OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  if(NOT output STREQUAL VERSION)
    message(FATAL_ERROR "${program} printed '${output}' instead of '${VERSION}'")
  endif()
  # What a static consumer must not need, a shared one must.
  execute_process(COMMAND ldd "${program}" OUTPUT_VARIABLE libraries COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCH "libpenumbra\\.so\\.[0-9.]+" needed "${libraries}")
  get_filename_component(name "${program}" NAME)
  if(name MATCHES "shared" AND NOT needed OR name MATCHES "static" AND needed)
    message(FATAL_ERROR "${program} loads '${needed}'")
  endif()
endfunction()

run("${CMAKE_COMMAND}" -S "${CONSUMER}" -B "${WORK}/cmake" -G "${GENERATOR}" "-DCMAKE_C_COMPILER=${CC}"
    "-DCMAKE_PREFIX_PATH=${root}" "-DWANTED_VERSION=${VERSION}" -DCMAKE_BUILD_TYPE=Debug)
run("${CMAKE_COMMAND}" --build "${WORK}/cmake")
run_consumer("${WORK}/cmake/shared")
run_consumer("${WORK}/cmake/static")

set(ENV{PKG_CONFIG_PATH} "${root}/${LIBDIR}/pkgconfig")
foreach(kind IN ITEMS shared static)
  set(option "")
  if(kind STREQUAL "static")
    set(option --static)
  endif()
  execute_process(COMMAND "${PKG_CONFIG}" ${option} --cflags --libs "penumbra = ${VERSION}" OUTPUT_VARIABLE flags
                  OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  if(kind STREQUAL "static")
    # pkg-config cannot choose between the two files of -lpenumbra; naming the archive does.
    list(TRANSFORM flags REPLACE "^-lpenumbra$" "-l:libpenumbra.a")
  endif()
  run("${CC}" -std=c99 "${CONSUMER}/main.c" ${flags} -o "${WORK}/pkg-config-${kind}")
  run_consumer("${WORK}/pkg-config-${kind}")
endforeach()
