# niivue, the viewer of reports: one file of its npm package.
#
# Sets ADAPTISO_NIIVUE_SCRIPT to the file, or to nothing where it can't be had: reports are then
# written without a viewer, and say so. -DADAPTISO_NIIVUE=niivue-niivue-0.69.0.tgz takes a package
# that is there already ("npm pack @niivue/niivue@0.69.0" makes one), for machines without npm or
# network.
set(ADAPTISO_NIIVUE "" CACHE FILEPATH "niivue's npm package (.tgz); empty: it is fetched")
set(niivueVersion 0.69.0)  # Packaging names both in the bill of materials
set(niivueSha512 60c8d0bc9803d56d9bec3ba8c64c250b85716eb80878f449e6ac90cd72b18b6bf6301560dbce4ffc2210ca0e3aa030c60c871a3656ddf8c86d3bf79d31b5c990)
include(${PROJECT_SOURCE_DIR}/Modules/FetchNpmFile.cmake)
adaptiso_npm_file(ADAPTISO_NIIVUE_SCRIPT PACKAGE @niivue/niivue VERSION ${niivueVersion}
    SHA512 ${niivueSha512}
    FILE dist/niivue.umd.js
    GIVEN "${ADAPTISO_NIIVUE}"
    WITHOUT "reports will have no viewer. -DADAPTISO_NIIVUE=<its .tgz> helps.")
