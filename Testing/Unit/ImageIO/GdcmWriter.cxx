#include "GdcmWriter.h"

#include <gdcmAttribute.h>
#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageWriter.h>
#include <gdcmMediaStorage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>
#include <gtest/gtest.h>

namespace adaptiso::testing {
namespace {

gdcm::TransferSyntax syntaxOf(DicomCodec codec) {
    switch (codec) {
        case DicomCodec::ImplicitLittleEndian:
            return gdcm::TransferSyntax::ImplicitVRLittleEndian;
        case DicomCodec::ExplicitLittleEndian:
            return gdcm::TransferSyntax::ExplicitVRLittleEndian;
        case DicomCodec::Rle:
            return gdcm::TransferSyntax::RLELossless;
        case DicomCodec::JpegLossless:
            return gdcm::TransferSyntax::JPEGLosslessProcess14_1;
        case DicomCodec::JpegLsLossless:
            return gdcm::TransferSyntax::JPEGLSLossless;
        case DicomCodec::Jpeg2000Lossless:
            return gdcm::TransferSyntax::JPEG2000Lossless;
    }
    return gdcm::TransferSyntax::TS_END;
}

}  // namespace

const char* uidOf(DicomCodec codec) {
    return gdcm::TransferSyntax::GetTSString(syntaxOf(codec));
}

std::string encodeWithGdcm(const std::vector<std::uint16_t>& samples, int columns, int rows,
                           int bits, bool isSigned, DicomCodec codec) {
    gdcm::Trace::WarningOff();
    gdcm::SmartPointer<gdcm::Image> image = new gdcm::Image;
    image->SetNumberOfDimensions(2);
    image->SetDimension(0, static_cast<unsigned>(columns));
    image->SetDimension(1, static_cast<unsigned>(rows));
    const auto stored = static_cast<unsigned short>(bits);
    image->SetPixelFormat(
        gdcm::PixelFormat(1, 16, stored, static_cast<unsigned short>(bits - 1), isSigned ? 1 : 0));
    image->SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
    image->SetTransferSyntax(gdcm::TransferSyntax::ExplicitVRLittleEndian);
    gdcm::DataElement pixels(gdcm::Tag(0x7fe0, 0x0010));
    pixels.SetByteValue(reinterpret_cast<const char*>(samples.data()),
                        static_cast<std::uint32_t>(samples.size() * sizeof(std::uint16_t)));
    image->SetDataElement(pixels);
    gdcm::ImageChangeTransferSyntax change;
    change.SetTransferSyntax(syntaxOf(codec));
    change.SetInput(*image);
    EXPECT_TRUE(change.Change());
    const auto* fragments = change.GetOutput().GetDataElement().GetSequenceOfFragments();
    EXPECT_EQ(fragments->GetNumberOfFragments(), 1U);
    std::string stream(fragments->ComputeByteLength(), '\0');
    EXPECT_TRUE(fragments->GetBuffer(stream.data(), stream.size()));
    return stream;
}

void writeWithGdcm(const std::filesystem::path& file, const std::vector<std::uint16_t>& samples,
                   int size, const Vec3& position, const Vec3& alongRow, const Vec3& alongColumn,
                   DicomCodec codec) {
    gdcm::Trace::WarningOff();  // its writer misses tags that it then adds
    gdcm::SmartPointer<gdcm::Image> image = new gdcm::Image;
    image->SetNumberOfDimensions(2);
    image->SetDimension(0, static_cast<unsigned>(size));
    image->SetDimension(1, static_cast<unsigned>(size));
    image->SetPixelFormat(gdcm::PixelFormat::UINT16);
    image->SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
    image->SetTransferSyntax(gdcm::TransferSyntax::ExplicitVRLittleEndian);
    image->SetSpacing(0, 0.5);
    image->SetSpacing(1, 0.5);
    const double cosines[] = {alongRow.x,    alongRow.y,    alongRow.z,
                              alongColumn.x, alongColumn.y, alongColumn.z};
    image->SetDirectionCosines(cosines);
    for (unsigned axis = 0; axis < 3; ++axis) {
        image->SetOrigin(axis, position[static_cast<int>(axis)]);
    }
    gdcm::DataElement pixels(gdcm::Tag(0x7fe0, 0x0010));
    pixels.SetByteValue(reinterpret_cast<const char*>(samples.data()),
                        static_cast<std::uint32_t>(samples.size() * sizeof(std::uint16_t)));
    image->SetDataElement(pixels);

    gdcm::ImageChangeTransferSyntax change;
    change.SetTransferSyntax(syntaxOf(codec));
    change.SetInput(*image);
    ASSERT_TRUE(change.Change());

    gdcm::ImageWriter writer;
    gdcm::DataSet& dataset = writer.GetFile().GetDataSet();
    gdcm::Attribute<0x0008, 0x0016> storage;
    storage.SetValue(gdcm::MediaStorage::GetMSString(gdcm::MediaStorage::CTImageStorage));
    dataset.Insert(storage.GetAsDataElement());
    gdcm::Attribute<0x0020, 0x000e> series;
    series.SetValue("1.2.3.4");
    dataset.Insert(series.GetAsDataElement());
    writer.SetImage(change.GetOutput());
    writer.SetFileName(file.c_str());
    ASSERT_TRUE(writer.Write());
}

}  // namespace adaptiso::testing
