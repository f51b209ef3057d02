# cmake -DOUTPUT=<.cxx> -DNAME=<name> -DFILE=<path> -P EmbedFile.cmake
# Writes a C++ file with the file's bytes: adaptiso::embedded::<name>(), a std::string_view, and
# <name>Sha256(), its bytes' SHA-256 in hexadecimal. A path that is empty gives empty ones.
set(bytes "")
set(size 0)
set(sha256 "")
if(FILE)
    file(READ "${FILE}" hex HEX)
    file(SHA256 "${FILE}" sha256)
    string(REGEX REPLACE "(..)" "\\\\x\\1" bytes "${hex}")
    string(LENGTH "${hex}" size)
    math(EXPR size "${size} / 2")
endif()
file(WRITE "${OUTPUT}" "// made by EmbedFile.cmake\n#include \"PageFiles.h\"\n\nnamespace adaptiso::embedded {\n"
     "std::string_view ${NAME}() {\n    return {\"${bytes}\", ${size}};\n}\n"
     "std::string_view ${NAME}Sha256() {\n    return \"${sha256}\";\n}\n"
     "}  // namespace adaptiso::embedded\n")
