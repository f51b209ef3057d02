#include "adaptiso/ItkAdaptor/ItkImageIO.h"

#include <itkMetaDataObject.h>
#include <itkObjectFactoryBase.h>
#include <itkVersion.h>

#include <cstring>
#include <filesystem>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/ImageIO/ListSeries.h"

namespace adaptiso {
namespace {

itk::IOComponentEnum componentOf(PixelType type) {
    using Component = itk::IOComponentEnum;
    constexpr Component kComponents[]{Component::UCHAR,     Component::CHAR,     Component::USHORT,
                                      Component::SHORT,     Component::UINT,     Component::INT,
                                      Component::ULONGLONG, Component::LONGLONG, Component::FLOAT,
                                      Component::DOUBLE};
    return kComponents[static_cast<int>(type)];
}

class Factory : public itk::ObjectFactoryBase {
public:
    using Self = Factory;
    using Pointer = itk::SmartPointer<Self>;
    // clang-format off
    itkFactorylessNewMacro(Self)
    itkTypeMacro(Factory, itk::ObjectFactoryBase);
    // clang-format on
    const char* GetITKSourceVersion() const override { return ITK_SOURCE_VERSION; }
    const char* GetDescription() const override { return "adaptiso's readers of images"; }

protected:
    Factory() {
        RegisterOverride("itkImageIOBase", "ItkImageIO", GetDescription(), true,
                         itk::CreateObjectFunction<ItkImageIO>::New());
    }
};

}  // namespace

bool ItkImageIO::CanReadFile(const char* name) {
    const std::string_view format = recognizeImage(name);
    if (format != "DICOM" || std::filesystem::is_directory(name)) return !format.empty();
    try {
        const std::vector<DicomSeries> series = listSeries(name).series;
        return series.size() != 1 || series.front().slices != 1;
    } catch (const Error&) {
        return true;  // reading says why not
    }
}

void ItkImageIO::ReadImageInformation() {
    try {
        read_ = readVolume(m_FileName, options_);
    } catch (const Error& error) {
        throw itk::ExceptionObject("adaptiso", 0, error.what(), GetNameOfClass());
    }
    const ImageGeometry& geometry = read_->volume.view().geometry();
    const Vec3 spacingMm = geometry.spacingMm();
    SetNumberOfDimensions(3);
    for (unsigned axis = 0; axis < 3; ++axis) {
        const auto n = static_cast<int>(axis);
        const Vec3& step = geometry.indexToPhysical.column[axis];
        SetDimensions(axis, static_cast<itk::SizeValueType>(geometry.size[axis]));
        SetSpacing(axis, spacingMm[n]);
        SetOrigin(axis, geometry.originMm[n]);
        SetDirection(axis, std::vector<double>{step.x / spacingMm[n], step.y / spacingMm[n],
                                               step.z / spacingMm[n]});
    }
    SetPixelType(itk::IOPixelEnum::SCALAR);
    SetNumberOfComponents(1);
    SetComponentType(componentOf(read_->volume.view().pixelType()));
    itk::MetaDataDictionary& dictionary = GetMetaDataDictionary();
    itk::EncapsulateMetaData<std::string>(dictionary, "adaptiso.format", read_->format);
    std::string lines;
    for (const std::string& line : linesOf(read_->warnings)) {
        lines += (lines.empty() ? "" : "\n") + line;
    }
    if (!lines.empty()) {
        itk::EncapsulateMetaData<std::string>(dictionary, "adaptiso.warnings", lines);
    }
}

void ItkImageIO::Read(void* buffer) {
    if (!read_) ReadImageInformation();
    const VolumeView& view = read_->volume.view();
    std::memcpy(buffer, view.samples(), view.byteCount());  // ITK asks for the whole: no streaming
    read_.reset();
}

void ItkImageIO::Write(const void*) {
    throw itk::ExceptionObject("adaptiso", 0, "adaptiso reads images, and writes none",
                               GetNameOfClass());
}

void registerItkImageIO() {
    static const Factory::Pointer factory = [] {
        auto made = Factory::New();
        itk::ObjectFactoryBase::RegisterFactory(made, itk::ObjectFactoryBase::INSERT_AT_FRONT);
        return made;
    }();
}

}  // namespace adaptiso
