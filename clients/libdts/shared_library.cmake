# SPDX-License-Identifier: Apache-2.0
# libdts.so as dts::dts, and what installs it: headers <dts/...>, find_package(dts), pkg-config dts.
# DTS_ABI is the number in the SONAME: raise it when a program that was compiled against the last release would not work any more.
set(DTS_ABI 0)
option(DTS_INSTALL "Install libdts and its headers" ${PROJECT_IS_TOP_LEVEL})

set(version_script ${CMAKE_CURRENT_SOURCE_DIR}/libdts.map)
add_library(dts SHARED $<TARGET_OBJECTS:dts_libdts>)
add_library(dts::dts ALIAS dts)
target_compile_features(dts PUBLIC cxx_std_20)
target_include_directories(dts PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>)
target_include_directories(dts SYSTEM PUBLIC $<BUILD_INTERFACE:$<TARGET_PROPERTY:dts_proto,INTERFACE_INCLUDE_DIRECTORIES>>)
target_link_libraries(dts PUBLIC protobuf::libprotobuf
  PRIVATE dts_wire dts_proto dts_zmtp PkgConfig::ZMQ PkgConfig::TOMLPLUSPLUS Threads::Threads)
target_link_options(dts PRIVATE LINKER:--version-script=${version_script} LINKER:-z,defs)
set_target_properties(dts PROPERTIES LINKER_LANGUAGE CXX LINK_DEPENDS ${version_script} LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib
  SOVERSION ${DTS_ABI} VERSION ${DTS_ABI}.${PROJECT_VERSION_MINOR})

if(NOT DTS_INSTALL)
  return()
endif()
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/dts)
install(TARGETS dts EXPORT dtsTargets COMPONENT libdts
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY include/dts DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT libdts)
get_target_property(generated dts_proto BINARY_DIR)
foreach(name options stream sessions control)  # the messages that the headers use
  install(FILES ${generated}/dts/v1/${name}.pb.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/dts/v1 COMPONENT libdts)
endforeach()

install(EXPORT dtsTargets NAMESPACE dts:: DESTINATION ${package} COMPONENT libdts)
configure_package_config_file(dtsConfig.cmake.in dtsConfig.cmake INSTALL_DESTINATION ${package})
# Until 1.0 a new minor version may change the interface.
write_basic_package_version_file(dtsConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/dtsConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/dtsConfigVersion.cmake DESTINATION ${package}
  COMPONENT libdts)

# dts.pc finds its folder by its own place: "cmake --install --prefix" may put it anywhere, even under a relative path.
file(RELATIVE_PATH prefix_from_pc ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
configure_file(dts.pc.in dts.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/dts.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT libdts)
