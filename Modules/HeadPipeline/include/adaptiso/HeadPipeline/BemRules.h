#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/Options.h"
#include "adaptiso/HeadPipeline/BemModel.h"

namespace adaptiso {

/// Numbers that shape a head model, by the report's order of keys.
const Options<BoundaryOptions>& boundaryOptions();
const Options<SourceOptions>& sourceOptions();

inline constexpr std::int64_t kLeastBemVertices = 42, kMostBemVertices = 200'000;

/// Set what is given as a list; setLayers() comes first, with the standard conductivities of as
/// many. \return false: as many values are not allowed
bool setLayers(BemModelOptions& options, std::int64_t layers);
bool setMinGaps(BemModelOptions& options, std::span<const double> gapsMm);
bool setEdgeLengths(BemModelOptions& options, std::span<const double> lengthsMm);
bool setConductivities(BemModelOptions& options, std::span<const double> sigmas);

inline constexpr const char* kMinGapRule = "one to four numbers of mm: SKULL,SCALP,CSF,GREY";
inline constexpr const char* kEdgeLengthRule = "two lengths in mm: MIN:MAX";
inline constexpr const char* kConductivityRule =
    "three to five numbers: [WHITE,]BRAIN,[CSF,]SKULL,SCALP in S/m";

/// A request for a head model, besides the model's own options.
struct BemRequest {
    std::set<std::string, std::less<>> given;  ///< inputs and options: "t1", "brain-mask"
    TissueLabels tissues;
    std::size_t surfaces = 0;     ///< ready ones
    std::size_t sources = 0;      ///< surfaces of the cortex
    std::string preset{};         ///< whose tissues; empty: none
    std::string missingSolver{};  ///< programs of {lead-field} that are not installed
};

/// Writes the name of an option ("max-skull") as the user knows it.
using BemNaming = std::function<std::string(const std::string& name)>;

/// `text` with each name in braces ("{max-skull} must be more than {min-gap}") by `naming`.
std::string named(const std::string& text, const BemNaming& naming);

/// Checks options by themselves, against each other, and against what is given.
/// \return the first rule that is broken, in one line; empty: none is
std::string bemFault(const BemModelOptions& options, const BemRequest& request,
                     const BemNaming& naming);

/// The images of a head, by source.
struct BemImages {
    std::vector<VolumeView> main;  ///< the T1, label map or CT, or the maps
    BrainSources brain;            ///< with a T1
    TissueLabels tissues;          ///< with labels
    std::optional<VolumeView> headMask;
};

/// Finds the boundaries of the model's head (stage "boundaries"). \pre the source is no surfaces
/// \throws InvalidInput  as the functions of HeadBoundaries.h, naming the input
HeadBoundaries findBoundaries(const BemModel& model, const BemImages& images, const BemHooks& hooks,
                              const BemNaming& naming);

}  // namespace adaptiso
