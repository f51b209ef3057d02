#pragma once

#include <string>

#include "Common/RunApp.h"
#include "adaptiso/Tetrahedra/MesherFiles.h"

namespace adaptiso {

/// Adds --tetrahedra and --element-size. \param files  that are written, for --help
void declareMesherOptions(CLI::App& app, MesherOptions& options, const std::string& files,
                          const char* heading);

/// \throws FileError  the mesher asked for is not installed
void requireMesher(const MesherOptions& options);

/// Runs the mesher, as a program. \return  what it made; labels are numbers of regions
/// \throws FileError  it is not installed, fails, or writes what can't be read
TetrahedralMesh runMesher(const MesherInput& input, const MesherOptions& options);

}  // namespace adaptiso
