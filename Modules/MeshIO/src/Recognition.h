#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso::meshio {

/// `bytes` without a UTF-8 byte order mark before them.
std::string_view withoutMark(std::string_view bytes);

/// Refuses images, surfaces of formats that are not read, and what findForeignContent() knows; says
/// what reads or converts them. \param head        the first kMeshHeadBytes bytes, unpacked \param
/// byteCount   of the file, unpacked \param isInflated  the file is gzip \throws FileError "<what
/// is wrong>; <what to do>"
void refuseOtherContent(std::string_view head, std::uint64_t byteCount,
                        const std::filesystem::path& path, bool isInflated);

}  // namespace adaptiso::meshio
