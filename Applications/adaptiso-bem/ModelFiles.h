#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "BemRun.h"
#include "Common/AtomicFolder.h"
#include "Common/AtomicOutput.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso {

/// Every name that a folder of this program may hold: what --force may replace.
std::vector<std::string_view> modelFileNames();

/// "inner_skull.surf"
std::string fileName(std::size_t surface, const char* extension);

/// Where --subject's surfaces go: SUBJECTS_DIR/SUBJECT/bem/<surface>.surf, one a surface.
std::vector<std::filesystem::path> subjectPaths(const BemOptions& options);

/// Writes the model into the folder: FreeSurfer surfaces, OpenMEEG's set, what else was asked for,
/// and README.md. Fills the run's files.
void writeModel(const std::vector<TriangleMesh>& surfaces, BemRun& run, AtomicFolder& folder);

/// The FreeSurfer surfaces once more, for the subject's own folder.
std::vector<AtomicOutput> writeSubject(const std::vector<TriangleMesh>& surfaces, BemRun& run);

}  // namespace adaptiso
