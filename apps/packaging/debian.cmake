# `cpack -G DEB` makes two packages: foucault, the program, and libfoucault-dev, libraries and
# headers. Packages of components other than the core are recommended: find_package() names them.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "Foucault contributors <contributors@foucault.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "post-processing of GNSS/IMU recordings")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME foucault)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS fonts-dejavu-core) # text in the figures
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS rtklib)           # import rinex, import ubx --base

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libfoucault-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libeigen3-dev, libfmt-dev, libyaml-cpp-dev")
string(CONCAT CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS
       "libceres-dev, libmrpt-obs-dev, libopencv-dev, libopencv-contrib-dev, nlohmann-json3-dev, "
       "zlib1g-dev, libpng-dev, libisal-dev, libbz2-dev, liblz4-dev, libzstd-dev, libsqlite3-dev")
include(CPack)
