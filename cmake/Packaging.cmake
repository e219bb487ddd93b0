# Debian packages: cmake --build build/release && (cd build/release && cpack -G DEB)
set(CPACK_PACKAGE_NAME ca2)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "calibration of LiDARs and cameras with a printed board")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
                                                WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL ca2 libca2-dev)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "Ca2 developers <ca2@localhost.localdomain>")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS OFF)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(CPACK_DEBIAN_CA2_PACKAGE_NAME ca2)
set(CPACK_DEBIAN_CA2_PACKAGE_SHLIBDEPS ON)
set(CPACK_COMPONENT_CA2_DESCRIPTION
"Finds where each LiDAR of a robot sits relative to each camera from a few
views of a printed checkerboard, ChArUco or AprilGrid, with an uncertainty
that can be believed, and exports the answer for ROS, URDF, Kalibr, OpenCV
and Autoware. This package has the command line: solving, reports, exports,
boards to print, recording and decoding of LiDAR packets, simulation.")

set(CPACK_DEBIAN_LIBCA2-DEV_PACKAGE_NAME libca2-dev)
set(CPACK_DEBIAN_LIBCA2-DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBCA2-DEV_PACKAGE_DEPENDS
    "libeigen3-dev, libopencv-dev, libpcl-dev, libyaml-cpp-dev, nlohmann-json3-dev, libpugixml-dev, libpng-dev, libturbojpeg0-dev, libexpected-dev, libapriltag-dev, libqhull-dev, libpcap-dev, libcpp-httplib-dev, libusb-1.0-0-dev, libssl-dev, pkg-config")
# For the LCM types.
set(CPACK_DEBIAN_LIBCA2-DEV_PACKAGE_SUGGESTS "liblcm-dev, liblcm-bin")
if(CA2_WITH_ARAVIS)
  string(APPEND CPACK_DEBIAN_LIBCA2-DEV_PACKAGE_DEPENDS ", libaravis-dev")
endif()
set(CPACK_COMPONENT_LIBCA2-DEV_DESCRIPTION
"Static libraries, headers and a CMake package of Ca2's parts: camera models,
board detection, LiDAR decoders, the solver; and its LCM message types.")

if(TARGET ca2d)
  list(APPEND CPACK_COMPONENTS_ALL ca2d)
  set(CPACK_DEBIAN_CA2D_PACKAGE_NAME ca2d)
  set(CPACK_DEBIAN_CA2D_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_CA2D_PACKAGE_DEPENDS "systemd | systemd-standalone-sysusers")
  set(CPACK_DEBIAN_CA2D_PACKAGE_RECOMMENDS ca2)
  set(CPACK_COMPONENT_CA2D_DESCRIPTION
"The capture daemon: watches a robot's LiDARs and cameras, captures a view
whenever the board is held still in a place that teaches something, and says
what to show next.")
  # CPack does not mark files under /etc as conffiles by itself.
  set(CPACK_DEBIAN_CA2D_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/debian/conffiles
      ${PROJECT_SOURCE_DIR}/cmake/debian/postinst ${PROJECT_SOURCE_DIR}/cmake/debian/prerm
      ${PROJECT_SOURCE_DIR}/cmake/debian/postrm)
  set(CPACK_DEBIAN_CA2D_PACKAGE_CONTROL_STRICT_PERMISSION ON)
endif()

# Every package has a changelog, a copyright and lintian overrides with their reasons.
foreach(component ${CPACK_COMPONENTS_ALL})
  set(stem ${PROJECT_BINARY_DIR}/debian/${component})
  configure_file(${PROJECT_SOURCE_DIR}/cmake/debian/changelog.in ${stem}/changelog @ONLY)
  execute_process(COMMAND ${CA2_GZIP} -9nkf ${stem}/changelog COMMAND_ERROR_IS_FATAL ANY)
  file(RENAME ${stem}/changelog.gz ${stem}/changelog.Debian.gz)
  install(FILES ${stem}/changelog.Debian.gz ${PROJECT_SOURCE_DIR}/cmake/debian/copyright
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${component} COMPONENT ${component})
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/debian/lintian-overrides
          DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides RENAME ${component} COMPONENT ${component})
endforeach()
include(CPack)
