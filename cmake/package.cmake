# A Debian package: `cpack -G DEB --config build/release/CPackConfig.cmake`. Its dependencies are
# those of the libraries that the tools are linked with.
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
install(DIRECTORY examples/scenes DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)

# A commit with the tag v<version> is that version; any other is one on the way to it.
execute_process(COMMAND git -C ${CMAKE_SOURCE_DIR} describe --exact-match --tags --match v${PROJECT_VERSION}
                RESULT_VARIABLE untagged OUTPUT_QUIET ERROR_QUIET)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
if(untagged)
    set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION}~g${QL_GIT_COMMIT})
endif()
set(CPACK_PACKAGE_NAME quietlight)
set(CPACK_PACKAGE_VENDOR Quietlight)
set(CPACK_PACKAGE_CONTACT "Quietlight <quietlight@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR DEB)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "gnuplot-nox, openimageio-tools")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
    "Blue-noise error distribution, reflective shadow maps and Linespace light\ninjection, with glTF scenes in and OpenEXR images out.")
include(CPack)
