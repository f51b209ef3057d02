#pragma once

#include <itkImageIOBase.h>

#include <optional>

#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso {

/// readVolume() as ITK reads: NIfTI, NRRD, MetaImage, MGH, DICOM (multi-frame files, mosaics,
/// folders of a series) and Zarr, with the geometry that readVolume() promises. Shear stays in the
/// direction. A DICOM file of one slice is left to ITK's own reader, which itk::ImageSeriesReader
/// needs.
///
/// Files that readVolume() refuses throw an itk::ExceptionObject with the same line. The dictionary
/// has `adaptiso.format` and, where there are any, `adaptiso.warnings` (one a line).
/// Reading the information decodes the file; its samples are kept until Read() has copied them.
class ItkImageIO : public itk::ImageIOBase {
public:
    using Self = ItkImageIO;
    using Superclass = itk::ImageIOBase;
    using Pointer = itk::SmartPointer<Self>;
    // clang-format off
    itkNewMacro(Self)
    itkTypeMacro(ItkImageIO, itk::ImageIOBase);
    // clang-format on

    /// Which series, volume, level ... to read where there are several.
    void SetReadOptions(const ReadOptions& options) { options_ = options; }

    bool CanReadFile(const char* name) override;
    void ReadImageInformation() override;
    void Read(void* buffer) override;
    bool CanWriteFile(const char*) override { return false; }
    void WriteImageInformation() override {}
    void Write(const void*) override;

private:
    ReadOptions options_;
    std::optional<ReadVolume> read_;
};

/// From now on itk::ImageFileReader asks ItkImageIO before its own readers.
void registerItkImageIO();

}  // namespace adaptiso
