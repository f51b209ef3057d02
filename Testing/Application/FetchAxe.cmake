# axe-core (MPL-2.0), which finds faults of pages for people who use keyboards and screen readers: one
# file of one version of its npm package, whose hash is known. A tool of the tests; nothing of it goes
# into the product.
#
# Sets ADAPTISO_AXE_SCRIPT to the file, or to nothing where it can't be had: the test that needs it is
# then skipped. -DADAPTISO_AXE=axe-core-4.14.1.tgz takes a package that is there already ("npm pack
# axe-core@4.14.1" makes one). Nothing of the package is run by npm pack.
set(ADAPTISO_AXE "" CACHE FILEPATH "axe-core's npm package (.tgz); empty: it is fetched")
set(axeVersion 4.14.1)
# the package's "integrity" in the registry, as hexadecimal digits
set(axeSha512 1477dafa598d8d065f273d6af302aa203c02e83131707b7fa648cd41bd3d6b734f8c22a0dab86ee6a6f64b8afbe804b214d36db85a2826965edfb3a0b9d546b5)
set(ADAPTISO_AXE_SCRIPT "")
set(axeFolder ${CMAKE_CURRENT_BINARY_DIR}/axe)
set(axePackage ${axeFolder}/axe-core-${axeVersion}.tgz)
if(ADAPTISO_AXE)
    set(axePackage ${ADAPTISO_AXE})
elseif(NOT EXISTS ${axePackage})
    find_program(ADAPTISO_NPM npm)
    mark_as_advanced(ADAPTISO_NPM)
    file(MAKE_DIRECTORY ${axeFolder})
    if(ADAPTISO_NPM)
        message(STATUS "Fetching axe-core ${axeVersion} by npm")
        execute_process(COMMAND ${ADAPTISO_NPM} pack --silent axe-core@${axeVersion}
                        WORKING_DIRECTORY ${axeFolder} TIMEOUT 120
                        OUTPUT_QUIET ERROR_QUIET)
    else()
        file(DOWNLOAD https://registry.npmjs.org/axe-core/-/axe-core-${axeVersion}.tgz
             ${axePackage} TIMEOUT 120 STATUS downloaded)
        list(GET downloaded 0 error)
        if(error)
            file(REMOVE ${axePackage})
        endif()
    endif()
endif()
if(NOT EXISTS ${axePackage})
    message(WARNING "axe-core ${axeVersion} is not to be had (npm's registry is not reached): whether "
                    "report pages serve everybody is not tested. -DADAPTISO_AXE=<its .tgz> helps.")
    return()
endif()
file(SHA512 ${axePackage} found)
if(NOT found STREQUAL axeSha512)
    message(FATAL_ERROR "${axePackage} is not axe-core ${axeVersion}: its SHA-512 is ${found}")
endif()
file(ARCHIVE_EXTRACT INPUT ${axePackage} DESTINATION ${axeFolder} PATTERNS package/axe.min.js)
set(ADAPTISO_AXE_SCRIPT ${axeFolder}/package/axe.min.js)
