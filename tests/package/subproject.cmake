# Penumbra inside a host's project, by add_subdirectory. The host can use both targets; nothing else of it changes: not
# its cache but for entries of penumbra's own, no variable and no property of its directory, nothing that it installs.
cmake_minimum_required(VERSION 3.22)

include("${CMAKE_CURRENT_LIST_DIR}/quietly.cmake")

function(configure name)
  run("${CMAKE_COMMAND}" -S "${HOST}" -B "${WORK}/${name}" -G "${GENERATOR}" "-DCMAKE_C_COMPILER=${CC}"
      "-DPROGRAM=${PROGRAM}" "-DCMAKE_INSTALL_PREFIX=${WORK}/installed-${name}" ${ARGN})
endfunction()

# The files below ${directory}, as a list.
function(files_below variable directory)
  file(GLOB_RECURSE files RELATIVE "${directory}" "${directory}/*")
  set(${variable} "${files}" PARENT_SCOPE)
endfunction()

# "NAME:TYPE=VALUE" of a build directory's cache, but for what penumbra may add to it: its options, what it looked for,
# and what CMake itself keeps about both. PENUMBRA is the test's.
set(own "^(PENUMBRA:|PENUMBRA_|penumbra_|epoxy_|pkgcfg_lib_epoxy_|PKG_CONFIG_)")
string(APPEND own
       "|^(__pkg_config_|prefix_result:|FIND_PACKAGE_MESSAGE_DETAILS_PkgConfig|CMAKE_NUMBER_OF_MAKEFILES)")
function(cache_of variable name)
  file(STRINGS "${WORK}/${name}/CMakeCache.txt" lines REGEX "^[A-Za-z_][A-Za-z_0-9-]*:[A-Z]+=")
  list(FILTER lines EXCLUDE REGEX "${own}")
  string(REPLACE "${WORK}/installed-${name}" "INSTALLED" lines "${lines}")
  string(REPLACE "${WORK}/${name}" "HERE" lines "${lines}")
  set(${variable} "${lines}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE "${WORK}")
configure(alone -DPENUMBRA=)
configure(with "-DPENUMBRA=${ROOT}")
cache_of(alone alone)
cache_of(with with)
set(added ${with})
list(REMOVE_ITEM added ${alone})
set(gone ${alone})
list(REMOVE_ITEM gone ${with})
if(added OR gone)
  message(FATAL_ERROR "the host's cache has\n  ${added}\ninstead of\n  ${gone}")
endif()
if(EXISTS "${WORK}/with/compile_commands.json")
  message(FATAL_ERROR "the host did not ask for compile_commands.json")
endif()

run("${CMAKE_COMMAND}" --build "${WORK}/with")
foreach(kind IN ITEMS penumbra static)
  execute_process(COMMAND "${WORK}/with/with_${kind}" OUTPUT_VARIABLE output OUTPUT_STRIP_TRAILING_WHITESPACE
                  COMMAND_ERROR_IS_FATAL ANY)
  if(NOT output STREQUAL VERSION)
    message(FATAL_ERROR "with_${kind} printed '${output}' instead of '${VERSION}'")
  endif()
endforeach()

run("${CMAKE_COMMAND}" --install "${WORK}/with")
files_below(installed "${WORK}/installed-with")
if(NOT installed STREQUAL "share/host/host.txt")
  list(JOIN installed "\n  " installed)
  message(FATAL_ERROR "the host installs\n  ${installed}")
endif()

# Where the host asks for it, all of it is there, beside the host's own, and under penumbra's name.
configure(with "-DPENUMBRA=${ROOT}" -DPENUMBRA_INSTALL=ON)
run("${CMAKE_COMMAND}" --build "${WORK}/with")
run("${CMAKE_COMMAND}" --install "${WORK}/with")
files_below(installed "${WORK}/installed-with")
foreach(file IN ITEMS include/penumbra/penumbra.h ${LIBDIR}/libpenumbra.a ${LIBDIR}/pkgconfig/penumbra.pc
                      ${LIBDIR}/cmake/penumbra/penumbra-config.cmake share/doc/penumbra/LICENSE)
  if(NOT file IN_LIST installed)
    list(JOIN installed "\n  " installed)
    message(FATAL_ERROR "with PENUMBRA_INSTALL=ON ${file} is missing from\n  ${installed}")
  endif()
endforeach()
