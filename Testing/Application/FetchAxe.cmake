# axe-core (MPL-2.0), which finds faults of pages for people who use keyboards and screen readers: one
# file of its npm package. A tool of the tests; nothing of it goes into the product.
#
# Sets ADAPTISO_AXE_SCRIPT to the file, or to nothing where it can't be had: the test that needs it is
# then skipped. -DADAPTISO_AXE=axe-core-4.14.1.tgz takes a package that is there already ("npm pack
# axe-core@4.14.1" makes one).
set(ADAPTISO_AXE "" CACHE FILEPATH "axe-core's npm package (.tgz); empty: it is fetched")
include(${PROJECT_SOURCE_DIR}/Modules/FetchNpmFile.cmake)
adaptiso_npm_file(ADAPTISO_AXE_SCRIPT PACKAGE axe-core VERSION 4.14.1
    SHA512 1477dafa598d8d065f273d6af302aa203c02e83131707b7fa648cd41bd3d6b734f8c22a0dab86ee6a6f64b8afbe804b214d36db85a2826965edfb3a0b9d546b5
    FILE axe.min.js
    GIVEN "${ADAPTISO_AXE}"
    WITHOUT "whether report pages serve everybody is not tested. -DADAPTISO_AXE=<its .tgz> helps.")
