#include "adaptiso/ImageIO/ItkReaders.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <utility>
#include <vector>

#include "HeaderText.h"
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

void addFoldersOf(const char* variable, std::vector<fs::path>& places) {
    const char* const value = std::getenv(variable);
    std::string_view list = value == nullptr ? "" : value;
    while (!list.empty()) {
        const std::size_t end = std::min(list.find(':'), list.size());
        if (end > 0) places.emplace_back(list.substr(0, end));
        list.remove_prefix(std::min(end + 1, list.size()));
    }
}

/// The folder of `file` and, for Bruker's pdata/1/2dseq, that of its acquisition (acqp, method);
/// git-annex's content of either.
void addFolderOf(const fs::path& file, std::vector<fs::path>& places) {
    std::error_code error;
    fs::path folder = fs::canonical(fs::absolute(file, error).parent_path(), error);
    if (error) return;
    const bool isBruker = file.filename() == "2dseq" && folder.parent_path().filename() == "pdata";
    if (isBruker) folder = folder.parent_path().parent_path();
    places.push_back(folder);
    for (; folder.has_relative_path(); folder = folder.parent_path()) {
        places.push_back(folder / ".git/annex/objects");
    }
}

/// Where ITK's readers may open files: beside the input, and where libraries are.
std::vector<fs::path> placesFor(const fs::path& input) {
    std::vector<fs::path> places{"/usr", "/lib", "/lib64", "/etc/ld.so.cache"};
    places.push_back(itkLibrary().parent_path());
    addFoldersOf("LD_LIBRARY_PATH", places);
    addFoldersOf("ITK_AUTOLOAD_PATH", places);
    addFolderOf(input, places);
    std::error_code error;
    const fs::path target = fs::canonical(input, error);
    if (!error) addFolderOf(target, places);
    return places;
}

}  // namespace

std::string withoutItkText() {
    if (!itkLibrary().empty()) return {};
    return "MINC and other formats of ITK need libadaptisoItkIO.so (Debian package adaptiso-itk), "
           "which is not here";
}

std::optional<ReadVolume> readWithItk(const fs::path& input, const ReadOptions& options) {
    if (itkLibrary().empty()) return std::nullopt;
    const auto allocate = [&](const ImageGeometry& geometry, PixelType type) {
        requireUsableGeometry(input, geometry);
        return allocateSamples(input, requireImageBytes(input, geometry.size, type));
    };
    const auto choose = [&](std::int64_t count) { return chooseVolume(input, count, options); };
    const auto read = [&] {
        std::optional<ReadVolume> result;
        const std::vector<fs::path> places = placesFor(input);
        const ItkReader reader = loadItkReader();
        // libminc writes MINC 1 (netCDF, which leads to no other file) anew in a temporary file
        const bool isNetCdf = readHead(input, 3) == "CDF";
        if (isInSandbox() && !isNetCdf) openOnlyBelow(places);
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
