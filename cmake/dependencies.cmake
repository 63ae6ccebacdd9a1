# Every library is a Debian package named in packages/debian.txt (GoogleTest: packages/debian-test.txt); heavy ones are linked only
# where they are used.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(CGAL REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(OpenSSL REQUIRED)
find_package(TIFF REQUIRED)
find_package(ZLIB REQUIRED)
find_package(LibXml2 REQUIRED)
find_package(MPI REQUIRED COMPONENTS CXX)
if(BUILD_TESTING)
    find_package(GTest REQUIRED)
endif()
pkg_check_modules(TOMLPLUSPLUS REQUIRED IMPORTED_TARGET tomlplusplus)

# Never two HDF5 in one process: the Open MPI build everywhere.
pkg_check_modules(HDF5 REQUIRED IMPORTED_TARGET hdf5-openmpi)

find_path(OPENVDB_INCLUDE_DIR openvdb/openvdb.h REQUIRED)
find_library(OPENVDB_LIBRARY openvdb REQUIRED)
find_package(Imath CONFIG REQUIRED)
