# One interface target carries every flag, so that no directory has flags of its own.
add_library(ca2_options INTERFACE)
# The headers are C++20 for whoever includes them.
target_compile_features(ca2_options INTERFACE cxx_std_20)
# Warnings are for building this project, not for programs that use the installed libraries.
target_compile_options(ca2_options INTERFACE "$<BUILD_INTERFACE:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wconversion;-Wno-sign-conversion;-Wnon-virtual-dtor;-Woverloaded-virtual;-Wcast-qual>")
# The same picture must give the same answer on every machine: no fused multiply-add where the source has none.
target_compile_options(ca2_options INTERFACE -ffp-contract=off)
if(CA2_WERROR)
  target_compile_options(ca2_options INTERFACE $<BUILD_INTERFACE:-Werror>)
endif()
target_include_directories(ca2_options INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                 $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/generated>
                                                 $<INSTALL_INTERFACE:include/ca2>)
# Programs that read packets from the network: no writable jump tables.
target_link_options(ca2_options INTERFACE $<BUILD_INTERFACE:-Wl,-z,relro,-z,now>)

if(CA2_SANITIZE)
  if(CA2_SANITIZE MATCHES "thread" AND CA2_SANITIZE MATCHES "address")
    message(FATAL_ERROR "CA2_SANITIZE=${CA2_SANITIZE}: the thread and address sanitizers exclude each other")
  endif()
  target_compile_options(ca2_options INTERFACE -fsanitize=${CA2_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(ca2_options INTERFACE -fsanitize=${CA2_SANITIZE})
  # GCC 12 looks at the wrong object where a polymorphic one's pointer to member is called, as LCM's subscriptions do:
  # 15 lines of a program of its own show it.
  if(CA2_SANITIZE MATCHES "undefined" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(ca2_options INTERFACE -fno-sanitize=vptr)
  endif()
endif()

if(CA2_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "CA2_FUZZ needs clang: cmake --preset fuzz")
  endif()
  target_compile_options(ca2_options INTERFACE -fsanitize=fuzzer-no-link)
endif()

find_program(CA2_CCACHE ccache)
if(CA2_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CA2_CCACHE})
endif()

configure_file(${PROJECT_SOURCE_DIR}/cmake/version.h.in ${PROJECT_BINARY_DIR}/generated/ca2_version.h @ONLY)
