// Entry point that ITK looks for in the libraries of ITK_AUTOLOAD_PATH.
#include <itkObjectFactoryBase.h>
#include <itkVersion.h>

#include "adaptiso/ItkAdaptor/ItkImageIO.h"

namespace {

/// ITK puts the factories of libraries behind its own, where only files that no reader of ITK takes
/// would reach them. So the real one is put in front, and ITK gets one that makes nothing.
class EmptyFactory : public itk::ObjectFactoryBase {
public:
    using Self = EmptyFactory;
    using Pointer = itk::SmartPointer<Self>;
    // clang-format off
    itkFactorylessNewMacro(Self)
    itkTypeMacro(EmptyFactory, itk::ObjectFactoryBase);
    // clang-format on
    const char* GetITKSourceVersion() const override { return ITK_SOURCE_VERSION; }
    const char* GetDescription() const override { return "adaptiso's plug-in"; }
};

}  // namespace

extern "C" itk::ObjectFactoryBase* itkLoad() {
    adaptiso::registerItkImageIO();
    static const EmptyFactory::Pointer factory = EmptyFactory::New();
    return factory;
}
