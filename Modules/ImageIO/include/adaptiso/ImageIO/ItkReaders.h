#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso {

/// A file that readVolume() has no reader of its own for.
struct ItkRequest {
    std::filesystem::path file;
    /// Memory for the samples. \throws FileError  the geometry makes no sense, no memory
    std::function<std::shared_ptr<std::byte[]>(const ImageGeometry&, PixelType)> allocate;
    /// The volume to take of so many. \throws FileError  there are several and none was asked for
    std::function<std::int64_t(std::int64_t count)> chooseVolume;
};

/// Function of libadaptisoItkIO.so for readVolume(): ITK's readers of other formats. It is loaded
/// by the sandbox process for such a file, and runs there.
/// `result` stays empty where no reader takes the file. \throws FileError
using ItkReader = void (*)(const ItkRequest& request, std::optional<ReadVolume>& result);
inline constexpr const char* kItkReaderName = "adaptisoReadWithItk";

}  // namespace adaptiso
