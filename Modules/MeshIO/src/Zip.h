#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "adaptiso/Core/Bytes.h"

namespace adaptiso::meshio {

/// Writes files into a zip archive, deflated, without dates.
/// \throws InvalidInput  they take more than 4 GB
void writeZip(const std::vector<std::pair<std::string, std::string>>& files, ByteSink& sink);

/// The files of a zip archive, stored or deflated. Names are found whatever their case.
class ZipFiles {
public:
    /// \param fileBytes  of the file on disk, by which the unpacked size is limited
    /// \throws FileError  it is cut off, or two archives are joined
    ZipFiles(std::string_view bytes, std::size_t fileBytes);

    bool has(const std::string& name) const;
    /// The bytes of a file. \throws FileError  it is not there, is encrypted, or damaged
    std::string read(const std::string& name);
    /// Bytes behind the end of the archive.
    std::string_view behind() const { return behind_; }

private:
    struct Entry {
        std::uint16_t flags = 0, method = 0;
        std::uint32_t checksum = 0;
        std::uint64_t packedBytes = 0, bytes = 0, at = 0;
    };

    std::string_view bytes_, behind_;
    std::size_t fileBytes_;
    std::map<std::string, Entry> entries_;
    std::uint64_t unpacked_ = 0;
};

}  // namespace adaptiso::meshio
