#pragma once

#include <filesystem>
#include <string_view>

#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// Writes a surface as Curry's text of boundary elements (.s00 to .s09): a description, a list of
/// points in mm, a list of triangles numbered from 0, counter-clockwise seen from outside. Nothing
/// in the format says the frame: put it into the description.
/// \param mesh         in the frame to be written
/// \param description  one line of printable ASCII
/// \throws InvalidInput  another description   \throws FileError  the file can't be written
void writeCurrySurface(const TriangleMesh& mesh, const std::filesystem::path& path,
                       std::string_view description);

/// Reads such a file. \throws FileError  "<file>: what is wrong; what to do"
TriangleMesh readCurrySurface(const std::filesystem::path& path);

/// The same from bytes in memory.
TriangleMesh decodeCurrySurface(std::string_view bytes, std::string_view name);

}  // namespace adaptiso
