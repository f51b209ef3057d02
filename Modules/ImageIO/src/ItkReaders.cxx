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

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

/// The library beside the program or Python module that this code is in: in lib/adaptiso/itk of a
/// folder above. Null where it is not installed.
ItkReader loadItkReader() {
    Dl_info own{};
    std::error_code error;
    std::vector<fs::path> places{fs::read_symlink("/proc/self/exe", error)};
    if (dladdr(reinterpret_cast<const void*>(&loadItkReader), &own) != 0) {
        places.push_back(fs::canonical(own.dli_fname, error));
    }
    for (fs::path place : places) {
        for (int level = 0; level < 5 && place.has_relative_path(); ++level) {
            place = place.parent_path();
            for (const char* folder : {"lib", ADAPTISO_LIBRARY_FOLDER}) {
                const fs::path file = place / folder / "adaptiso/itk/libadaptisoItkIO.so";
                if (!fs::exists(file, error)) continue;
                void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
                if (library == nullptr) continue;
                return reinterpret_cast<ItkReader>(dlsym(library, kItkReaderName));
            }
        }
    }
    return nullptr;
}

/// Loaded here, since a forked child should not.
ItkReader itkReader() {
    static const ItkReader reader = loadItkReader();
    return reader;
}

}  // namespace

bool hasItkReaders() {
    return itkReader() != nullptr;
}

std::optional<ReadVolume> readWithItk(const fs::path& input, const ReadOptions& options) {
    const ItkReader reader = itkReader();
    if (reader == nullptr) return std::nullopt;
    const auto allocate = [&](const ImageGeometry& geometry, PixelType type) {
        requireUsableGeometry(input, geometry);
        return allocateSamples(input, requireImageBytes(input, geometry.size, type));
    };
    const auto choose = [&](std::int64_t count) { return chooseVolume(input, count, options); };
    const auto read = [&] {
        std::optional<ReadVolume> result;
        reader({input, allocate, choose}, result);
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
