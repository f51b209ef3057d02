#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ByteSource.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/ImageIO/ReadVolume.h"

/// A NRRD file's text header, after teem.sourceforge.net/nrrd/format.html.
namespace adaptiso::detail {

struct NrrdHeader {
    std::map<std::string, std::string, std::less<>> fields;  ///< names without blanks, lower case
    std::map<std::string, std::string, std::less<>> pairs;   ///< key:=value, keys as they are
    std::uint64_t byteCount = 0;                             ///< up to and with the blank line

    std::optional<std::string_view> find(std::string_view name) const {
        const auto it = fields.find(name);
        if (it == fields.end()) return std::nullopt;
        return it->second;
    }
    /// \throws FileError when it is not there
    std::string_view require(const std::filesystem::path& file, std::string_view name) const;
};

/// The three axes in space, and an axis of volumes where there is one.
struct NrrdAxes {
    Index3 size{};
    std::int64_t volumeCount = 1;
    std::optional<std::size_t> volumeAxis;  ///< 0 (side by side) or 3 (one after the other)

    std::size_t count() const { return volumeAxis ? 4 : 3; }
};

/// All of the following throw FileError where the header is damaged, or says something that is
/// not read here: colour, components, spaces that do not name left and right.
NrrdHeader readNrrdHeader(const std::filesystem::path& file);
PixelType pixelTypeOf(const std::filesystem::path& file, const NrrdHeader& header);
NrrdAxes axesOf(const std::filesystem::path& file, const NrrdHeader& header);
/// The noun for the items along the axis of volumes: "volumes", or the layers of 3D Slicer's
/// segments that overlap, with their names.
std::string volumesNameOf(const NrrdHeader& header);
/// \param given  the space where the header names none that tells left from right
ImageGeometry geometryOf(const std::filesystem::path& file, const NrrdHeader& header,
                         const NrrdAxes& axes, std::optional<ImageSpace> given,
                         std::vector<Warning>& warnings);

/// Samples that stand in a file as decimal numbers, apart by blanks or commas.
///
/// Whole numbers may be written as 12, 12.0 or 1.2e1; of floating-point types NaN and infinities
/// are numbers too. A few numbers too many are left out with a warning.
/// \throws FileError  numbers are missing, one is no number or none of this type (300 for 8 bits,
///         1.5 for integers, 1e99 for float), or as many more follow as more slices would have
Volume readNrrdText(const std::filesystem::path& file, ByteSource& source, PixelType type,
                    const ImageGeometry& geometry, std::vector<Warning>& warnings);

}  // namespace adaptiso::detail
