#include "adaptiso/ImageIO/ItkReaders.h"

#include <dlfcn.h>

#include <utility>
#include <vector>

#include "Readers.h"
#include "Samples.h"
#include "Sandbox.h"
#include "adaptiso/Core/Errors.h"

#ifndef ADAPTISO_LIBRARY_FOLDER  // below the prefix; fuzzers have none
#define ADAPTISO_LIBRARY_FOLDER "lib"
#endif
#ifndef ADAPTISO_PYTHON_FOLDER
#define ADAPTISO_PYTHON_FOLDER "python"
#endif

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

/// `folder` without `end`; empty if it does not end so.
fs::path prefixOf(fs::path folder, const fs::path& end) {
    for (auto part = end.end(); part != end.begin(); folder = folder.parent_path()) {
        if (folder.filename() != *--part) return {};
    }
    return folder;
}

/// The library where it is installed with the program or Python module that this code is in, and
/// nowhere else: a library in another folder may be anybody's. Empty where it is not installed.
fs::path itkLibrary() {
    Dl_info own{};
    std::error_code error;
    std::vector<fs::path> files{fs::read_symlink("/proc/self/exe", error)};
    if (dladdr(reinterpret_cast<const void*>(&itkLibrary), &own) != 0) {
        files.push_back(fs::canonical(own.dli_fname, error));
    }
    for (const fs::path& file : files) {
        for (const char* end : {"bin", ADAPTISO_PYTHON_FOLDER "/adaptiso", "python/adaptiso"}) {
            const fs::path prefix = prefixOf(file.parent_path(), end);
            for (const char* folder : {"lib", ADAPTISO_LIBRARY_FOLDER}) {
                fs::path library = prefix / folder / "adaptiso/itk/libadaptisoItkIO.so";
                if (!prefix.empty() && fs::exists(library, error)) return library;
            }
        }
    }
    return {};
}

ItkReader loadItkReader() {
    void* const library = dlopen(itkLibrary().c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) return nullptr;
    return reinterpret_cast<ItkReader>(dlsym(library, kItkReaderName));
}

}  // namespace

bool hasItkReaders() {
    return !itkLibrary().empty();
}

std::optional<ReadVolume> readWithItk(const fs::path& input, const ReadOptions& options) {
    if (!hasItkReaders()) return std::nullopt;
    const auto allocate = [&](const ImageGeometry& geometry, PixelType type) {
        requireUsableGeometry(input, geometry);
        return allocateSamples(input, requireImageBytes(input, geometry.size, type));
    };
    const auto choose = [&](std::int64_t count) { return chooseVolume(input, count, options); };
    const auto read = [&] {
        std::optional<ReadVolume> result;
        const ItkReader reader = loadItkReader();
        if (reader != nullptr) reader({input, allocate, choose}, result);
        if (!result) throw InvalidInput("");
        return std::move(*result);
    };
    try {
        return options.sandbox ? readInSandbox(input, sandboxLimitsFor(input), read) : read();
    } catch (const InvalidInput& error) {
        if (*error.what() != '\0') throw;
        return std::nullopt;
    }
}

}  // namespace adaptiso::detail
