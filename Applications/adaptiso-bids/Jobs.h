#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "Common/Batch.h"
#include "Pipeline.h"

namespace adaptiso::bids {

/// One kind of result, as a batch of another program.
struct Job {
    std::string product;  ///< of kProducts
    std::string needs;    ///< "T1w image"
    BatchProgram program;
    BatchOptions batch;
    std::vector<PlannedRun> runs;
    std::vector<std::string> without;  ///< participants without an image for it: "sub-03"
};

/// The request for a product, kept in its records for the group level; of all products, a list.
Json requestOf(const BidsOptions& options, const std::string& product);
Json requestOf(const BidsOptions& options);

/// All that is asked for except the check, for the images of `subjects`. `options` outlives it.
/// \throws UsageError  an option that the program lacks  \throws InvalidInput
std::vector<Job> findJobs(const BidsOptions& options,
                          const std::vector<std::filesystem::path>& subjects);

/// The check of the surfaces that the records of `surfaces` list.
Job checkJob(const BidsOptions& options, const Job& surfaces);

/// Another program of adaptiso, installed beside this one.
struct ProgramInfo {
    std::string name;  ///< "adaptiso-mesh"
    std::filesystem::path executable;
    std::string version;               ///< as --version prints it
    std::vector<std::string> options;  ///< long names without dashes
};

/// The options in `list`, "iso=100,largest,crop=:,:,40:", as the program takes them: "--iso=100",
/// "--largest", "--crop=:,:,40:". A part that is no lower-case name, or name and '=', belongs to
/// the value before it. \param option    that has the value `list`, for messages: "--surfaces"
/// \param refused   options that adaptiso-bids sets
/// \throws UsageError  the program lacks the option, or it is one of `refused`
std::vector<std::string> programOptions(const std::string& option, const std::string& list,
                                        const ProgramInfo& program,
                                        const std::vector<std::string>& refused);

}  // namespace adaptiso::bids
