# A Debian package: `cpack -G DEB --config build/release/CPackConfig.cmake`. Its dependencies are
# those of the libraries that the tools are linked with.
install(FILES README.md CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
install(DIRECTORY examples/scenes DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)
install(DIRECTORY examples/overview/images DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples/overview)

# The version comes from git: v1.2.3 is 1.2.3, and five commits later 1.2.3+5.gabc1234. Before the
# first tag it is that of project() with the number of commits, which sorts before the release:
# 0.1.0~87.gabc1234. Without git it is that of project().
if(NOT QL_GIT_COMMIT STREQUAL unknown)
    execute_process(COMMAND git -C ${CMAKE_SOURCE_DIR} describe --tags --long --match v[0-9]*
                    OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    execute_process(COMMAND git -C ${CMAKE_SOURCE_DIR} rev-list --count HEAD
                    OUTPUT_VARIABLE commits OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(described MATCHES "^v(.+)-0-g[0-9a-f]+$")
    set(CPACK_PACKAGE_VERSION ${CMAKE_MATCH_1})
elseif(described MATCHES "^v(.+)-([0-9]+)-(g[0-9a-f]+)$")
    set(CPACK_PACKAGE_VERSION ${CMAKE_MATCH_1}+${CMAKE_MATCH_2}.${CMAKE_MATCH_3})
elseif(commits)
    set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION}~${commits}.g${QL_GIT_COMMIT})
else()
    set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
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
