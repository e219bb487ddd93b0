# Cross build for 64-bit ARM (Jetson, Raspberry Pi) on Debian 12: docs/cross-build.md
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)

# The sysroot that tools/arm64-sysroot.sh makes, by -DCA2_SYSROOT=DIR; also known to CMake's own trial projects.
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES CA2_SYSROOT)
if(NOT CA2_SYSROOT)
  message(FATAL_ERROR "give -DCA2_SYSROOT=DIR, made by tools/arm64-sysroot.sh DIR")
endif()
set(CMAKE_SYSROOT ${CA2_SYSROOT})
set(CMAKE_FIND_ROOT_PATH ${CA2_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
# BLAS and LAPACK are chosen by update-alternatives, which no sysroot has run.
add_link_options(-Wl,-rpath-link,${CA2_SYSROOT}/usr/lib/aarch64-linux-gnu
                 -Wl,-rpath-link,${CA2_SYSROOT}/usr/lib/aarch64-linux-gnu/blas
                 -Wl,-rpath-link,${CA2_SYSROOT}/usr/lib/aarch64-linux-gnu/lapack)

# pkg-config of the build machine with the sysroot's .pc files.
set(ENV{PKG_CONFIG_DIR} "")
set(ENV{PKG_CONFIG_LIBDIR} ${CA2_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${CA2_SYSROOT}/usr/share/pkgconfig:${CA2_SYSROOT}/usr/lib/pkgconfig)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${CA2_SYSROOT})
