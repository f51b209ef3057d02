#pragma once

#include "Pipeline.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

namespace adaptiso {

/// What can be told of the file of --index before the volume is read.
/// \throws FileError  it is missing or not a regular file
void checkIndexFile(const MeshOptions& options);

/// The index of the volume: the one that --index names, or a new one. options.index becomes what it
/// was built with.
/// \throws FileError     the file can't be read
/// \throws InvalidInput  it is no index, damaged, that of another image, or made with other options
///                       than the user gives
SpanSpaceIndex prepareIndex(const VolumeView& volume, MeshOptions& options);

}  // namespace adaptiso
