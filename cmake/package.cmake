# cpack -G DEB: one package with library, headers and CMake and pkg-config files, from the install rules.
set(CPACK_PACKAGE_NAME libwellspaced-dev)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_VENDOR "wellspaced")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Sparse well-spaced Delaunay refinement: quality tetrahedra, few elements")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_GENERATOR DEB)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "wellspaced developers <noreply@example.org>")
set(CPACK_DEBIAN_PACKAGE_SECTION libdevel)
# What the shared library needs; dpkg-shlibdeps would find the same, where it is installed.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libc6, libgcc-s1")
include(CPack)
