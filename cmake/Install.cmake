# What goes where, by component: ca2 (the command line), libca2-dev (libraries, headers, messages). The daemon's own
# rules are in systemd/.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS ca2 RUNTIME COMPONENT ca2)
install(FILES ${PROJECT_SOURCE_DIR}/completions/ca2.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        RENAME ca2 COMPONENT ca2)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/config/scenarios DESTINATION ${CMAKE_INSTALL_DATADIR}/ca2 COMPONENT ca2)
file(GLOB manuals ${PROJECT_SOURCE_DIR}/docs/*.md)
install(FILES ${manuals} ${PROJECT_SOURCE_DIR}/README.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/ca2 COMPONENT ca2)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/images DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/ca2 COMPONENT ca2)

# Manual pages: commands' from their own --help, so that they cannot disagree. That needs to run the program: a cross
# build has none.
if(NOT CMAKE_CROSSCOMPILING)
  set(page ${PROJECT_BINARY_DIR}/man/ca2.1.gz)
  add_custom_command(OUTPUT ${page}
    COMMAND ${PROJECT_SOURCE_DIR}/tools/man-page.sh $<TARGET_FILE:ca2> ${page}
    DEPENDS ca2 ${PROJECT_SOURCE_DIR}/tools/man-page.sh COMMENT "ca2(1)" VERBATIM)
  add_custom_target(ca2_man ALL DEPENDS ${page})
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ca2)
endif()

# install_manual(PAGE COMPONENT): written by hand, compressed as Debian has them.
find_program(CA2_GZIP gzip REQUIRED)
function(install_manual page component)
  string(REGEX MATCH "[0-9]$" section ${page})
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/man)
  execute_process(COMMAND ${CA2_GZIP} -9nc ${PROJECT_SOURCE_DIR}/docs/man/${page}
                  OUTPUT_FILE ${PROJECT_BINARY_DIR}/man/${page}.gz COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${PROJECT_BINARY_DIR}/man/${page}.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man${section}
          COMPONENT ${component})
endfunction()
install_manual(ca2-session.5 ca2)
if(TARGET ca2d)
  install_manual(ca2d.8 ca2d)
  install_manual(ca2d.yaml.5 ca2d)
endif()

# For programs that use the parts: find_package(ca2), target ca2::ca2_core and ca2::ca2_drivers.
install(TARGETS ca2_options ca2_core ca2_drivers EXPORT ca2_targets ARCHIVE COMPONENT libca2-dev)
foreach(layer core drivers)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${layer} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/ca2 COMPONENT libca2-dev
          FILES_MATCHING PATTERN "*.h" PATTERN "*.def"
          PATTERN models EXCLUDE PATTERN formats EXCLUDE PATTERN sources EXCLUDE)  # directories without headers
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/messages/lcm DESTINATION ${CMAKE_INSTALL_DATADIR}/ca2 COMPONENT libca2-dev)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/ca2)
install(EXPORT ca2_targets NAMESPACE ca2:: DESTINATION ${package} COMPONENT libca2-dev)
configure_file(${PROJECT_SOURCE_DIR}/cmake/ca2Config.cmake.in ${PROJECT_BINARY_DIR}/ca2Config.cmake @ONLY)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/ca2ConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/ca2Config.cmake ${PROJECT_BINARY_DIR}/ca2ConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/Dependencies.cmake DESTINATION ${package} COMPONENT libca2-dev)
