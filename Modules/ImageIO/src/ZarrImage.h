#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "ZarrArray.h"
#include "ZarrScene.h"
#include "ZarrStore.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::detail {

/// The dimensions of an array that are x, y and z, and the positions where the others are cut.
struct ZarrCut {
    std::array<std::size_t, 3> space{};  ///< dimension of x, y, z
    ZarrIndex fixed;                     ///< index in each other dimension

    bool isSpace(std::size_t dimension) const;
};

/// An image of a hierarchy, as its metadata say; no chunk has been looked at.
struct ZarrImage {
    ZarrStore store;
    ZarrScene scene;
    ZarrArray array;
    ZarrCut cut;
    ImageGeometry geometry;

    std::string format() const;
};

/// \throws FileError  as readVolume()
ZarrImage openZarrImage(const std::filesystem::path& folder, const ReadOptions& options);

/// A part of an image, a box of voxels.
struct ZarrRegion {
    Index3 first{0, 0, 0}, size{0, 0, 0};
};

/// The part of an image that was read.
struct ZarrPart {
    Volume volume;  ///< with the part's own place
    std::int64_t chunks = 0, missing = 0;
    bool hasMoreBeyond = false;  ///< of the whole image: its chunks hold more, beyond its shape
};

/// Reads the chunks that a part touches, each once. \pre it lies in the image, and is not empty
/// \throws FileError
ZarrPart readZarrPart(const ZarrImage& image, const ZarrRegion& region);

/// Calls f(key) for the files, shards or chunks, that a part touches, whether they are there or
/// not.
void forEachZarrFile(const ZarrImage& image, const ZarrRegion& region,
                     const std::function<void(const std::string&)>& f);

}  // namespace adaptiso::detail
