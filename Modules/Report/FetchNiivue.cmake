# niivue, the viewer of reports: one file of one version of its npm package, whose hash is known.
#
# Sets ADAPTISO_NIIVUE_SCRIPT to the file, or to nothing where it can't be had: reports are then
# written without a viewer, and say so. -DADAPTISO_NIIVUE=niivue-niivue-0.69.0.tgz takes a package
# that is there already ("npm pack @niivue/niivue@0.69.0" makes one), for machines without npm or
# network. Nothing of the package is run here: npm pack fetches and does no more.
set(ADAPTISO_NIIVUE "" CACHE FILEPATH "niivue's npm package (.tgz); empty: it is fetched")
set(niivueVersion 0.69.0)
# the package's "integrity" in the registry, as hexadecimal digits
set(niivueSha512 60c8d0bc9803d56d9bec3ba8c64c250b85716eb80878f449e6ac90cd72b18b6bf6301560dbce4ffc2210ca0e3aa030c60c871a3656ddf8c86d3bf79d31b5c990)
set(ADAPTISO_NIIVUE_SCRIPT "")
set(niivueFolder ${CMAKE_CURRENT_BINARY_DIR}/niivue)
set(niivuePackage ${niivueFolder}/niivue-niivue-${niivueVersion}.tgz)
if(ADAPTISO_NIIVUE)
    set(niivuePackage ${ADAPTISO_NIIVUE})
elseif(NOT EXISTS ${niivuePackage})
    find_program(ADAPTISO_NPM npm)
    mark_as_advanced(ADAPTISO_NPM)
    file(MAKE_DIRECTORY ${niivueFolder})
    if(ADAPTISO_NPM)
        message(STATUS "Fetching niivue ${niivueVersion} by npm")
        execute_process(COMMAND ${ADAPTISO_NPM} pack --silent @niivue/niivue@${niivueVersion}
                        WORKING_DIRECTORY ${niivueFolder} TIMEOUT 120
                        OUTPUT_QUIET ERROR_QUIET)
    else()
        file(DOWNLOAD https://registry.npmjs.org/@niivue/niivue/-/niivue-${niivueVersion}.tgz
             ${niivuePackage} TIMEOUT 120 STATUS downloaded)
        list(GET downloaded 0 error)
        if(error)
            file(REMOVE ${niivuePackage})
        endif()
    endif()
endif()
if(NOT EXISTS ${niivuePackage})
    message(WARNING "niivue ${niivueVersion} is not to be had (npm's registry is not "
                    "reached): reports will have no viewer. -DADAPTISO_NIIVUE=<its .tgz> helps.")
    return()
endif()
file(SHA512 ${niivuePackage} found)
if(NOT found STREQUAL niivueSha512)
    message(FATAL_ERROR "${niivuePackage} is not niivue ${niivueVersion}: its SHA-512 is ${found}")
endif()
file(ARCHIVE_EXTRACT INPUT ${niivuePackage} DESTINATION ${niivueFolder}
     PATTERNS package/dist/niivue.umd.js)
set(ADAPTISO_NIIVUE_SCRIPT ${niivueFolder}/package/dist/niivue.umd.js)
