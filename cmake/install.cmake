# Installation: the library for CMake and pkg-config users, the program, the manual page.

include(CMakePackageConfigHelpers)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/penumbra")

install(DIRECTORY include/penumbra DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" FILES_MATCHING PATTERN "*.h")
foreach(kind IN ITEMS shared static)
  set(target penumbra)
  if(kind STREQUAL "static")
    set(target penumbra_static)
  endif()
  # Two export files, because only users of the static library need libepoxy's development files.
  target_include_directories(${target} INTERFACE "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
  install(TARGETS ${target} EXPORT penumbra-${kind} LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}"
          ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
  install(EXPORT penumbra-${kind} NAMESPACE penumbra:: FILE penumbra-${kind}.cmake DESTINATION "${package_dir}")
endforeach()

configure_package_config_file(cmake/penumbra-config.cmake.in penumbra-config.cmake INSTALL_DESTINATION "${package_dir}")
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(penumbra-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/penumbra-config.cmake" "${PROJECT_BINARY_DIR}/penumbra-config-version.cmake"
        DESTINATION "${package_dir}")

# Relative to the .pc file where that is possible, so that an installed tree may be moved.
file(RELATIVE_PATH pc_prefix "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
string(REGEX REPLACE "/$" "" pc_prefix "\${pcfiledir}/${pc_prefix}")
if(IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}")
  set(pc_prefix "${CMAKE_INSTALL_PREFIX}")
endif()
foreach(dir IN ITEMS LIBDIR INCLUDEDIR)
  set(pc_${dir} "${CMAKE_INSTALL_${dir}}")
  if(NOT IS_ABSOLUTE "${pc_${dir}}")
    string(PREPEND pc_${dir} "\${prefix}/")
  endif()
endforeach()
configure_file(cmake/penumbra.pc.in penumbra.pc @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/penumbra.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")

if(TARGET penumbra_program)
  # Finds the library beside itself, wherever both are installed.
  file(RELATIVE_PATH to_library "/${CMAKE_INSTALL_BINDIR}" "/${CMAKE_INSTALL_LIBDIR}")
  set_target_properties(penumbra_program PROPERTIES INSTALL_RPATH "\$ORIGIN/${to_library}")
  install(TARGETS penumbra_program RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
  install(FILES docs/penumbra.1 DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" OPTIONAL)
endif()
# Where this is a part of another project, CMAKE_INSTALL_DOCDIR is that project's.
set(doc_dir "${CMAKE_INSTALL_DOCDIR}")
if(NOT PROJECT_IS_TOP_LEVEL)
  set(doc_dir "${CMAKE_INSTALL_DATAROOTDIR}/doc/penumbra")
endif()
install(FILES LICENSE README.md CHANGELOG.md DESTINATION "${doc_dir}" OPTIONAL)
