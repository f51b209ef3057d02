// A plug-in as others make them for ITK_AUTOLOAD_PATH: images with "by others" in the beginning.
#include <itkImageIOBase.h>
#include <itkObjectFactoryBase.h>
#include <itkVersion.h>

#include <fstream>

namespace {

class OthersImageIO : public itk::ImageIOBase {
public:
    using Self = OthersImageIO;
    using Pointer = itk::SmartPointer<Self>;
    // clang-format off
    itkNewMacro(Self)
    itkTypeMacro(OthersImageIO, itk::ImageIOBase);
    // clang-format on
    bool CanReadFile(const char* name) override {
        std::string head(64, '\0');
        std::ifstream(name).read(head.data(), 64);
        return head.find("by others") != std::string::npos;
    }
    void ReadImageInformation() override {
        SetNumberOfDimensions(3);
        for (unsigned axis = 0; axis < 3; ++axis) {
            SetDimensions(axis, 8 - 2 * axis);
            SetSpacing(axis, axis == 0 ? 2 : axis == 1 ? 1.5 : 2.5);
            SetOrigin(axis, axis == 0 ? 10 : axis == 1 ? -20 : 30);
        }
        SetComponentType(itk::IOComponentEnum::USHORT);
    }
    void Read(void* buffer) override {
        auto* samples = static_cast<unsigned short*>(buffer);
        for (unsigned short n = 0; n < 192; ++n) samples[n] = 100 + n;
    }
    bool CanWriteFile(const char*) override { return false; }
    void WriteImageInformation() override {}
    void Write(const void*) override {}
};

class OthersFactory : public itk::ObjectFactoryBase {
public:
    using Self = OthersFactory;
    using Pointer = itk::SmartPointer<Self>;
    // clang-format off
    itkFactorylessNewMacro(Self)
    itkTypeMacro(OthersFactory, itk::ObjectFactoryBase);
    // clang-format on
    const char* GetITKSourceVersion() const override { return ITK_SOURCE_VERSION; }
    const char* GetDescription() const override { return "a format of others"; }

private:
    OthersFactory() {
        RegisterOverride("itkImageIOBase", "OthersImageIO", "", true,
                         itk::CreateObjectFunction<OthersImageIO>::New());
    }
};

}  // namespace

extern "C" itk::ObjectFactoryBase* itkLoad() {
    static const OthersFactory::Pointer factory = OthersFactory::New();
    return factory;
}
