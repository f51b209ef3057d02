#include "adaptiso/ImageIO/ImageRegions.h"

#include <fmt/core.h>
#include <sys/stat.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "FileFault.h"
#include "Samples.h"
#include "ZarrImage.h"

namespace adaptiso {
namespace fs = std::filesystem;

/// An image by its parts.
class ImageRegions::Impl {
public:
    virtual ~Impl() = default;
    virtual bool readsParts() const = 0;
    virtual std::optional<double> constantIn(const detail::ZarrRegion& part) const = 0;
    virtual std::string stampOf(const detail::ZarrRegion& part) const = 0;
    virtual Volume read(const detail::ZarrRegion& part) const = 0;

    ImageGeometry geometry;
    PixelType type{};
    std::string format;
    std::vector<Warning> warnings;
};

namespace {

using detail::ZarrRegion;

/// "<size> <seconds>.<nanoseconds>"; empty: there is no such file. \throws FileError
std::string fileStamp(const fs::path& path) {
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) {
        if (errno == ENOENT) return {};
        detail::refuse(path, std::string("can't be looked at: ") + std::strerror(errno),
                       "check the disk");
    }
    return fmt::format("{} {}.{:09}", status.st_size, status.st_mtim.tv_sec,
                       status.st_mtim.tv_nsec);
}

}  // namespace

/// Chunks are read when they are asked for.
class ZarrRegions final : public ImageRegions::Impl {
public:
    ZarrRegions(const fs::path& input, const ReadOptions& options)
        : image_(detail::openZarrImage(input, options)), options_(options) {
        geometry = image_.geometry;
        type = image_.array.type;
        format = image_.format();
        warnings = image_.scene.warnings;
    }

    bool readsParts() const override { return true; }

    std::optional<double> constantIn(const ZarrRegion& part) const override {
        bool isAbsent = true;
        forEachZarrFile(image_, part, [&](const std::string& key) {
            isAbsent = isAbsent && fileStamp(image_.store.root() / key).empty();
        });
        if (!isAbsent || options_.refusesMissingChunks) return std::nullopt;
        const double fill = withPixelType(type, [&]<class T>(T value) {
            std::memcpy(&value, image_.array.fill.data(), sizeof value);
            return static_cast<double>(value);
        });
        if (std::isnan(fill)) return std::nullopt;
        return fill;
    }

    std::string stampOf(const ZarrRegion& part) const override {
        std::string text = encodingText();
        forEachZarrFile(image_, part, [&](const std::string& key) {
            const std::string stamp = fileStamp(image_.store.root() / key);
            text.append(key).append(" ").append(stamp.empty() ? "missing" : stamp).append("\n");
        });
        return text;
    }

    Volume read(const ZarrRegion& part) const override {
        detail::ZarrPart got = readZarrPart(image_, part);
        if (got.missing > 0 && options_.refusesMissingChunks) {
            detail::refuse(image_.store.root(),
                           fmt::format("{} of {} chunks are not there", got.missing, got.chunks),
                           "get the whole dataset, or leave --refuse-missing-chunks out");
        }
        return std::move(got.volume);
    }

private:
    /// Metadata about samples that neither chunks nor the geometry give.
    std::string encodingText() const {
        const detail::ZarrArray& array = image_.array;
        std::string text = "fill";
        for (const std::byte byte : array.fill)
            text += fmt::format(" {:d}", std::to_integer<int>(byte));
        text += array.encoding.byteOrder == std::endian::big ? "\nbig" : "\nlittle";
        for (const std::size_t n : array.encoding.order) text += fmt::format(" {}", n);
        return text + "\n";
    }

    detail::ZarrImage image_;
    ReadOptions options_;
};

/// The whole image is there.
class WholeImage final : public ImageRegions::Impl {
public:
    WholeImage(const fs::path& input, const ReadOptions& options)
        : input_(input), read_(readVolume(input, options)) {
        geometry = read_.volume.view().geometry();
        type = read_.volume.view().pixelType();
        format = read_.format;
        warnings = read_.warnings;
    }

    bool readsParts() const override { return false; }
    std::optional<double> constantIn(const ZarrRegion&) const override { return std::nullopt; }
    std::string stampOf(const ZarrRegion&) const override { return fileStamp(input_) + "\n"; }

    Volume read(const ZarrRegion& part) const override {
        return dispatchPixelType(read_.volume, [&]<class T>(const TypedVolumeView<T>& whole) {
            std::vector<T> samples;
            samples.reserve(static_cast<std::size_t>(part.size[0] * part.size[1] * part.size[2]));
            for (std::int64_t k = 0; k < part.size[2]; ++k) {
                for (std::int64_t j = 0; j < part.size[1]; ++j) {
                    const T* row = &whole.at(part.first[0], part.first[1] + j, part.first[2] + k);
                    samples.insert(samples.end(), row, row + part.size[0]);
                }
            }
            ImageGeometry place = geometry;
            place.originMm = geometry.toPhysical({static_cast<double>(part.first[0]),
                                                  static_cast<double>(part.first[1]),
                                                  static_cast<double>(part.first[2])});
            place.size = part.size;
            return Volume::fromSamples(std::move(samples), place);
        });
    }

private:
    fs::path input_;
    ReadVolume read_;
};

ImageRegions ImageRegions::open(const fs::path& input, const ReadOptions& options) {
    std::error_code error;
    if (fs::is_directory(input, error) && detail::isZarrFolder(input)) {
        return ImageRegions(std::make_unique<ZarrRegions>(input, options));
    }
    return ImageRegions(std::make_unique<WholeImage>(input, options));
}

ImageRegions::ImageRegions(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ImageRegions::ImageRegions(ImageRegions&&) noexcept = default;
ImageRegions& ImageRegions::operator=(ImageRegions&&) noexcept = default;
ImageRegions::~ImageRegions() = default;

const ImageGeometry& ImageRegions::geometry() const {
    return impl_->geometry;
}
PixelType ImageRegions::pixelType() const {
    return impl_->type;
}
const std::string& ImageRegions::format() const {
    return impl_->format;
}
const std::vector<Warning>& ImageRegions::warnings() const {
    return impl_->warnings;
}
bool ImageRegions::readsParts() const {
    return impl_->readsParts();
}
std::optional<double> ImageRegions::constantIn(const Index3& first, const Index3& size) const {
    return impl_->constantIn({first, size});
}
std::string ImageRegions::stampOf(const Index3& first, const Index3& size) const {
    return impl_->stampOf({first, size});
}
Volume ImageRegions::read(const Index3& first, const Index3& size) const {
    return impl_->read({first, size});
}

}  // namespace adaptiso
