#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso {

/// An image that is read part by part, for those that are too large to be held.
///
/// Zarr is read chunk by chunk, as far as a part touches them; other formats are read as a whole
/// when opened.
class ImageRegions {
public:
    /// \throws FileError, InvalidInput  as readVolume(), but for what chunks hold
    static ImageRegions open(const std::filesystem::path& input, const ReadOptions& options);

    ImageRegions(ImageRegions&&) noexcept;
    ImageRegions& operator=(ImageRegions&&) noexcept;
    ~ImageRegions();

    const ImageGeometry& geometry() const;
    PixelType pixelType() const;
    const std::string& format() const;
    const std::vector<Warning>& warnings() const;
    bool readsParts() const;  ///< no more is in memory than what is asked for

    /// The value of all samples of a part, where known without reading: no chunk of it is
    /// there. NaN is no answer.
    std::optional<double> constantIn(const Index3& first, const Index3& size) const;

    /// Size and time of change of the files that hold a part, to detect changes; and
    /// which of them are not there. A line each.
    std::string stampOf(const Index3& first, const Index3& size) const;

    /// The samples of a part, tightly packed, with their own place in space.
    /// \pre the part lies in the image, and is not empty   \throws FileError
    Volume read(const Index3& first, const Index3& size) const;

    class Impl;

private:
    explicit ImageRegions(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace adaptiso
