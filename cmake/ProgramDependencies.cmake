# What the programs and their messages need beyond the libraries (Dependencies.cmake).
find_package(CLI11 REQUIRED)
# No CMake package of LCM in Debian: pkg-config, and lcm-gen by hand (messages/CMakeLists.txt).
pkg_check_modules(LCM REQUIRED IMPORTED_TARGET lcm)
pkg_check_modules(SODIUM REQUIRED IMPORTED_TARGET libsodium)
pkg_check_modules(SYSTEMD REQUIRED IMPORTED_TARGET libsystemd)
find_package(spdlog REQUIRED)
pkg_check_modules(CHAFA REQUIRED IMPORTED_TARGET chafa)
