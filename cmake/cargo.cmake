# How cargo is driven: it decides itself what is out of date, so the targets here always run it.
# Gives the imported targets wellspaced::wellspaced and wellspaced::static, and wellspaced_lib_dir.

find_program(WELLSPACED_CARGO cargo HINTS ENV CARGO_HOME PATHS "$ENV{HOME}/.cargo" PATH_SUFFIXES bin
             DOC "The cargo that compiles wellspaced")
if(NOT WELLSPACED_CARGO)
  message(FATAL_ERROR "wellspaced: cargo was not found. Install Rust 1.85 or later, or set WELLSPACED_CARGO.")
endif()
set(WELLSPACED_CARGO_PROFILE release CACHE STRING "Cargo's profile, whatever CMAKE_BUILD_TYPE is")
set(WELLSPACED_CARGO_TARGET "" CACHE STRING "Cargo's --target, for cross-compiling")
set(WELLSPACED_CARGO_TARGET_DIR "${CMAKE_CURRENT_BINARY_DIR}/cargo" CACHE PATH "Where cargo builds")
mark_as_advanced(WELLSPACED_CARGO WELLSPACED_CARGO_PROFILE WELLSPACED_CARGO_TARGET WELLSPACED_CARGO_TARGET_DIR)

# The ABI version, which the SONAME carries, has one home too: the header.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS include/wellspaced.h)
file(STRINGS include/wellspaced.h wellspaced_abi REGEX "^#define WSP_ABI_VERSION [0-9]+$")
string(REGEX REPLACE ".* " "" wellspaced_abi "${wellspaced_abi}")

set(cargo_options --locked --manifest-path ${CMAKE_CURRENT_SOURCE_DIR}/Cargo.toml --package wellspaced
    --profile ${WELLSPACED_CARGO_PROFILE})
set(output_subdir "")
if(WELLSPACED_CARGO_TARGET)
  list(APPEND cargo_options --target ${WELLSPACED_CARGO_TARGET})
  set(output_subdir ${WELLSPACED_CARGO_TARGET}/)
endif()
if(WELLSPACED_CARGO_PROFILE STREQUAL dev)
  string(APPEND output_subdir debug)
else()
  string(APPEND output_subdir ${WELLSPACED_CARGO_PROFILE})
endif()
# The library has a folder of its own: the command's build makes another library of the same name, and in one folder
# each would throw the other away.
set(library_target_dir ${WELLSPACED_CARGO_TARGET_DIR}/library)
set(library_output ${library_target_dir}/${output_subdir})
set(command_output ${WELLSPACED_CARGO_TARGET_DIR}/${output_subdir})

set(wellspaced_lib_dir ${CMAKE_CURRENT_BINARY_DIR}/lib)
set(wellspaced_static_name ${CMAKE_STATIC_LIBRARY_PREFIX}wellspaced${CMAKE_STATIC_LIBRARY_SUFFIX})
if(WIN32)
  message(FATAL_ERROR "wellspaced: this build makes ELF and Mach-O libraries only; on Windows use cargo itself.")
elseif(APPLE)
  set(wellspaced_names libwellspaced.${PROJECT_VERSION}.dylib libwellspaced.${wellspaced_abi}.dylib libwellspaced.dylib)
  set(wellspaced_soname @rpath/libwellspaced.${wellspaced_abi}.dylib)
  set(soname_flag -Wl,-install_name,${wellspaced_soname})
  set(wellspaced_private_libraries m)
else()
  set(wellspaced_names libwellspaced.so.${PROJECT_VERSION} libwellspaced.so.${wellspaced_abi} libwellspaced.so)
  set(wellspaced_soname libwellspaced.so.${wellspaced_abi})
  set(soname_flag -Wl,-soname,${wellspaced_soname})
  # What Rust's standard library needs of the system.
  set(wellspaced_private_libraries pthread dl m)
endif()
list(GET wellspaced_names 0 shared_file)
list(GET wellspaced_names 1 shared_soname_link)
list(GET wellspaced_names 2 shared_link)

# As a part of another project it is built when something links it.
set(all "")
if(PROJECT_IS_TOP_LEVEL OR WELLSPACED_INSTALL)
  set(all ALL)
endif()
# Without the rlib, which link-time optimisation would have to leave out.
add_custom_target(
  wellspaced_cargo ${all}
  COMMAND ${WELLSPACED_CARGO} rustc ${cargo_options} --target-dir ${library_target_dir} --lib
          --crate-type cdylib,staticlib -- -C link-arg=${soname_flag}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${wellspaced_lib_dir}
  COMMAND ${CMAKE_COMMAND} -E copy_if_different ${library_output}/${shared_link} ${wellspaced_lib_dir}/${shared_file}
  COMMAND ${CMAKE_COMMAND} -E create_symlink ${shared_file} ${wellspaced_lib_dir}/${shared_soname_link}
  COMMAND ${CMAKE_COMMAND} -E create_symlink ${shared_soname_link} ${wellspaced_lib_dir}/${shared_link}
  COMMAND ${CMAKE_COMMAND} -E copy_if_different ${library_output}/${wellspaced_static_name}
          ${wellspaced_lib_dir}/${wellspaced_static_name}
  BYPRODUCTS ${wellspaced_lib_dir}/${shared_file} ${wellspaced_lib_dir}/${wellspaced_static_name}
  COMMENT "cargo: library wellspaced"
  USES_TERMINAL VERBATIM)

set(wellspaced_command ${wellspaced_lib_dir}/../bin/wellspaced)
cmake_path(NORMAL_PATH wellspaced_command)
set(all "")
if(WELLSPACED_BUILD_COMMAND OR WELLSPACED_BUILD_TESTS)
  set(all ALL)
endif()
add_custom_target(
  wellspaced_command ${all}
  COMMAND ${WELLSPACED_CARGO} build ${cargo_options} --target-dir ${WELLSPACED_CARGO_TARGET_DIR} --features cli
          --bin wellspaced
  COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_CURRENT_BINARY_DIR}/bin
  COMMAND ${CMAKE_COMMAND} -E copy_if_different ${command_output}/wellspaced ${wellspaced_command}
  BYPRODUCTS ${wellspaced_command}
  COMMENT "cargo: command wellspaced"
  USES_TERMINAL VERBATIM)

add_library(wellspaced::wellspaced SHARED IMPORTED GLOBAL)
set_target_properties(
  wellspaced::wellspaced
  PROPERTIES IMPORTED_LOCATION ${wellspaced_lib_dir}/${shared_file}
             IMPORTED_SONAME ${wellspaced_soname}
             INTERFACE_INCLUDE_DIRECTORIES ${CMAKE_CURRENT_SOURCE_DIR}/include)
add_dependencies(wellspaced::wellspaced wellspaced_cargo)

add_library(wellspaced::static STATIC IMPORTED GLOBAL)
set_target_properties(
  wellspaced::static
  PROPERTIES IMPORTED_LOCATION ${wellspaced_lib_dir}/${wellspaced_static_name}
             INTERFACE_LINK_LIBRARIES "${wellspaced_private_libraries}"
             INTERFACE_INCLUDE_DIRECTORIES ${CMAKE_CURRENT_SOURCE_DIR}/include)
add_dependencies(wellspaced::static wellspaced_cargo)
