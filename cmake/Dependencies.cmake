# What the libraries need; the README's table says what each is for. Installed with them: find_package(ca2) reads it too.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgproc calib3d)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(pugixml REQUIRED)
find_package(PNG REQUIRED)
find_package(tl-expected REQUIRED)
find_package(Threads REQUIRED)
# PCL's include path through pkg-config: its CMake package insists on VTK, and its .pc files list MPI and HDF5,
# which nothing here links. The libraries are linked by name.
find_package(PkgConfig REQUIRED)
pkg_check_modules(PCL REQUIRED pcl_common)
pkg_check_modules(PCAP REQUIRED IMPORTED_TARGET libpcap)
# HTTP to sensors. Its .pc file defines the TLS and compression switches the compiled half was built with.
pkg_check_modules(HTTPLIB REQUIRED IMPORTED_TARGET cpp-httplib)
# The T265; and the check of its firmware file.
pkg_check_modules(LIBUSB REQUIRED IMPORTED_TARGET libusb-1.0)
pkg_check_modules(CRYPTO REQUIRED IMPORTED_TARGET libcrypto)
pkg_check_modules(TURBOJPEG REQUIRED IMPORTED_TARGET libturbojpeg)
# GigE Vision and USB3 Vision cameras.
if(CA2_WITH_ARAVIS)
  pkg_check_modules(ARAVIS REQUIRED IMPORTED_TARGET aravis-0.8)
endif()
pkg_check_modules(APRILTAG REQUIRED IMPORTED_TARGET apriltag)
pkg_check_modules(QHULL REQUIRED IMPORTED_TARGET qhull_r)
