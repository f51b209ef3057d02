#pragma once

#include <ostream>
#include <string>

#include "Common/Verdict.h"
#include "Info.h"

namespace adaptiso {

/// --info for people.
void printInfo(std::ostream& out, const MeshOptions& options, const ImageInfo& info);

/// --info for machines, as README.md documents it.
std::string infoJson(const MeshOptions& options, const ImageInfo& info, const Verdict& verdict);

}  // namespace adaptiso
