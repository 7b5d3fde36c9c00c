# What `cmake --install` puts where. Everything finds its neighbours relative to itself, so the prefix may be moved.
include(CMakePackageConfigHelpers)

list(TRANSFORM wellspaced_names PREPEND ${wellspaced_lib_dir}/ OUTPUT_VARIABLE shared_files)
install(FILES ${shared_files} ${wellspaced_lib_dir}/${wellspaced_static_name} DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp")
if(WELLSPACED_BUILD_COMMAND)
  install(PROGRAMS ${wellspaced_command} DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/wellspaced)
configure_package_config_file(
  cmake/wellspacedConfig.cmake.in wellspacedConfig.cmake INSTALL_DESTINATION ${package_dir}
  PATH_VARS CMAKE_INSTALL_LIBDIR CMAKE_INSTALL_INCLUDEDIR NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file(wellspacedConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/wellspacedConfig.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/wellspacedConfigVersion.cmake DESTINATION ${package_dir})

# pkg-config's paths, from the .pc file's own place where the directories are relative to the prefix.
if(IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}")
  set(pc_prefix "${CMAKE_INSTALL_PREFIX}")
  set(pc_libdir "${CMAKE_INSTALL_LIBDIR}")
else()
  file(RELATIVE_PATH up "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
  string(REGEX REPLACE "/$" "" up "${up}")
  set(pc_prefix "\${pcfiledir}/${up}")
  set(pc_libdir "\${prefix}/${CMAKE_INSTALL_LIBDIR}")
endif()
if(IS_ABSOLUTE "${CMAKE_INSTALL_INCLUDEDIR}")
  set(pc_includedir "${CMAKE_INSTALL_INCLUDEDIR}")
else()
  set(pc_includedir "\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}")
endif()
list(TRANSFORM wellspaced_private_libraries PREPEND -l OUTPUT_VARIABLE pc_private)
list(JOIN pc_private " " pc_private)
configure_file(cmake/wellspaced.pc.in wellspaced.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/wellspaced.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
