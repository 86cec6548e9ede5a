# What `cmake --install` gives: the command, the library for find_package(tafoni), headers and licences.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/tafoni)

add_library(tafoni_umbrella INTERFACE)
set_target_properties(tafoni_umbrella PROPERTIES EXPORT_NAME tafoni)
target_link_libraries(tafoni_umbrella INTERFACE ${modules})
target_compile_features(tafoni_umbrella INTERFACE cxx_std_20)
add_library(tafoni::tafoni ALIAS tafoni_umbrella)

if(TARGET tafoni)
  install(TARGETS tafoni)
endif()
install(TARGETS ${modules} tafoni_umbrella EXPORT tafoni_targets)
install(EXPORT tafoni_targets FILE tafoniTargets.cmake NAMESPACE tafoni:: DESTINATION ${package_dir})

# Only what a stranger may use: impl/ is a module's own (but for *.inl.h, which public templates include), inner/
# the house's, *-inl.h the code of kernels, and the rooms of landforms/ (site/, rock/, one a landform) serve
# landforms alone. tests/install compiles each header against what is installed, so that none includes one that
# is not.
file(GLOB_RECURSE headers RELATIVE ${CMAKE_SOURCE_DIR}/src CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/tafoni/*.h)
set(inline_headers ${headers})
list(FILTER inline_headers INCLUDE REGEX "\\.inl\\.h$")
list(FILTER headers EXCLUDE REGEX "/(test|impl|inner)/|-inl\\.h$|^tafoni/landforms/.*/")
foreach(header IN LISTS headers inline_headers)
  get_filename_component(dir ${header} DIRECTORY)
  install(FILES ${CMAKE_SOURCE_DIR}/src/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${dir})
endforeach()

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/tafoniConfig.cmake.in
                              ${CMAKE_BINARY_DIR}/tafoniConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/tafoniConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/tafoniConfig.cmake ${CMAKE_BINARY_DIR}/tafoniConfigVersion.cmake
        ${CMAKE_CURRENT_LIST_DIR}/FindOpenVDB.cmake DESTINATION ${package_dir})
install(FILES ${CMAKE_SOURCE_DIR}/LICENSE ${CMAKE_SOURCE_DIR}/THIRD_PARTY.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
