#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Arrays.h"
#include "MeshData.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"
#include "adaptiso/HeadPipeline/BemFiles.h"
#include "adaptiso/HeadPipeline/BemModel.h"

namespace adaptiso::python {

namespace py = pybind11;

/// Input of a head model: images, or ready surfaces.
struct HeadSources {
    std::string source;  ///< "t1", "labels", "probabilities", "ct", "surfaces"
    std::vector<std::shared_ptr<ArrayVolume>> images;  ///< with surfaces: the one they belong to
    std::shared_ptr<ArrayVolume> brainMask, aseg;      ///< with t1; may be null
    std::shared_ptr<ArrayVolume> headMask;             ///< with labels; may be null
    std::vector<std::shared_ptr<MeshData>> pial;       ///< with t1: the cortex
    TissueLabels tissues;
    std::vector<std::shared_ptr<MeshData>> surfaces;  ///< inside out, in one frame
    std::vector<BemInput> inputs;                     ///< one for each of them
    std::vector<Warning> warnings;                    ///< of reading
};

/// A head model, or the reason for its absence.
class HeadModelData {
public:
    /// Makes a head model as adaptiso-bem does, from the samples on.
    /// \throws InvalidInput  what is no head's
    static std::shared_ptr<HeadModelData> make(const HeadSources& sources,
                                               const BemModelOptions& options, int threads,
                                               py::object progress);

    const BemModel& model() const { return model_; }

    /// The surfaces, inside out, in scanner RAS mm; where there is no model, what it was tried
    /// from.
    std::vector<std::shared_ptr<MeshData>> surfaces() const;

    /// Result of `adaptiso-check --nested --profile bem`, with the gaps asked for; JSON.
    std::string check(int threads) const;

    /// The report adaptiso-bem/1.
    std::string report(const BemFileOptions& options) const;

    /// Writes the model's files into a folder that is there, and report.json; reads them back and
    /// checks them again.
    /// \throws InvalidInput  they don't keep what is promised
    void write(const std::filesystem::path& folder, const BemFileOptions& options) const;

    /// The page of adaptiso-bem's --report.
    std::string page(bool leavesOutFaces) const;

private:
    using Files = std::vector<std::pair<std::string, std::uintmax_t>>;

    std::string reportOf(const BemModel& model, const BemFileOptions& options,
                         const Files& files) const;

    BemModel model_;
    std::shared_ptr<ArrayVolume> shown_;  ///< the main image
    bool isLoose_ = false;                ///< in tkRAS of a volume that is not known
    int threads_ = 0;
    std::vector<std::pair<std::string, double>> seconds_;  ///< by stage
    double totalSeconds_ = 0;
    double peakMemoryMb_ = 0;
};

}  // namespace adaptiso::python
