#include "ItkDecoder.h"

#include <itkNrrdImageIO.h>
#include <itkObject.h>

#include "Fence.h"
#include "FileFault.h"

namespace adaptiso::detail {
namespace {

using Io = itk::ImageIOBase;

/// ITK's warnings go to stderr by default; what matters has been checked before.
class SilentItk {
public:
    SilentItk() : wasOn_(itk::Object::GetGlobalWarningDisplay()) {
        itk::Object::GlobalWarningDisplayOff();
    }
    ~SilentItk() { itk::Object::SetGlobalWarningDisplay(wasOn_); }
    SilentItk(const SilentItk&) = delete;
    SilentItk& operator=(const SilentItk&) = delete;

private:
    bool wasOn_;
};

bool isFloating(PixelType type) {
    return type == PixelType::Float32 || type == PixelType::Float64;
}

bool isSigned(PixelType type) {
    return withPixelType(type, []<class T>(T) { return std::numeric_limits<T>::is_signed; });
}

/// long and long long are one pixel type here, two in ITK: compare what matters.
bool isSameType(Io& io, PixelType type) {
    using Component = itk::IOComponentEnum;
    const Component component = io.GetComponentType();
    const bool ioIsFloating = component == Component::FLOAT || component == Component::DOUBLE;
    const bool ioIsUnsigned = component == Component::UCHAR || component == Component::USHORT ||
                              component == Component::UINT || component == Component::ULONG ||
                              component == Component::ULONGLONG;
    return io.GetComponentSize() == bytesPerPixel(type) && ioIsFloating == isFloating(type) &&
           ioIsUnsigned == !isSigned(type) && io.GetNumberOfComponents() == 1;
}

}  // namespace

Volume decodeNrrdWithItk(const std::filesystem::path& file, PixelType type,
                         const ImageGeometry& geometry) {
    blameBehindFence(file);
    const SilentItk silence;
    const std::uint64_t byteCount = requireImageBytes(file, geometry.size, type);
    try {
        const auto io = itk::NrrdImageIO::New();
        io->SetFileName(file.native());
        io->ReadImageInformation();
        itk::ImageIORegion whole(io->GetNumberOfDimensions());
        for (unsigned axis = 0; axis < io->GetNumberOfDimensions(); ++axis) {
            const auto expected = axis < 3 ? static_cast<std::uint64_t>(geometry.size[axis]) : 1;
            if (io->GetDimensions(axis) != expected) {
                refuse(file, "ITK reads another image size from its header", "repair the header");
            }
            whole.SetSize(axis, expected);
        }
        if (!isSameType(*io, type)) {
            refuse(file, "ITK reads another data type from its header", "repair the header");
        }
        SampleBuffer samples = allocateSamples(file, byteCount);
        io->SetIORegion(whole);
        io->Read(samples.get());
        return makeVolume(std::move(samples), type, geometry);
    } catch (const Error&) {
        throw;
    } catch (const std::exception&) {  // its text is several lines of source places
        refuse(file, "ITK can't decode its data", "the file is damaged or of an unknown kind");
    }
}

}  // namespace adaptiso::detail
