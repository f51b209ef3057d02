#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ZarrStore.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso::detail {

/// Meaning of an array's dimension.
struct ZarrAxis {
    enum class Kind { Space, Channel, Time, Other };
    Kind kind = Kind::Other;
    std::string name;            ///< "z"
    std::optional<double> toMm;  ///< of a unit of space; none: it is not said
};

/// One image of a hierarchy, in one of its resolutions.
struct ZarrScene {
    std::string format;                ///< "Zarr 2", "OME-Zarr 0.4"
    std::string path;                  ///< of the array
    std::vector<ZarrAxis> axes;        ///< of its dimensions; may be empty (unknown)
    std::vector<double> scale, shift;  ///< of each dimension, in its units: scale * index + shift
    bool saysScale = false;            ///< else `scale` is 1, or a level's alone
    std::int64_t levels = 1;
    std::vector<Warning> warnings;
};

/// Content at the root of a store: an array, the multiscales of an OME-Zarr of version 0.4 or
/// 0.5, or what N5 has of both. \param level  of resolution, 0 the finest \throws FileError  it
/// holds neither, is of another version, or has not that level
ZarrScene findZarrScene(const ZarrStore& store, std::int64_t level);

/// The folder holds what the metadata of Zarr or N5 are kept in.
bool isZarrFolder(const std::filesystem::path& folder);

/// Millimetres in a unit of UDUNITS-2, as NGFF names them, or its symbol; none for blanks and
/// pixels. \throws FileError  unknown
std::optional<double> millimetresOf(const std::filesystem::path& file, const std::string& unit);

[[noreturn]] void refuseLevel(const std::filesystem::path& file, std::int64_t level,
                              std::int64_t levels);

}  // namespace adaptiso::detail
