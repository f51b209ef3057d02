#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/Batch.h"
#include "Common/BatchPlan.h"
#include "Common/BatchRecord.h"

namespace adaptiso {

/// What earlier runs have left of a planned record.
struct EarlierRecord {
    std::optional<KeptRecord> record{};  ///< none: there is none that can be read
    std::string why{};    ///< why it would have to be made again; empty: it would come out the same
    bool isThere = true;  ///< false: neither a record nor a surface is
};

/// Compares what earlier runs of a batch have left with what it would make: version, options, and
/// the content of inputs and outputs.
class EarlierRuns {
public:
    /// \pre both outlive this
    EarlierRuns(const BatchProgram& program, const BatchPlan& plan);

    /// Of every record that the item's run is to leave, in the plan's order.
    /// \param trustsTimes  files of the size and times that were kept are not read
    std::vector<EarlierRecord> look(std::size_t item, bool trustsTimes = false);

    /// All of the item's records need not be made again. \pre `found` is of look()
    static bool areDone(const std::vector<EarlierRecord>& found);
    /// The first reason to make the item again; empty: none, or nothing is there.
    static std::string reasonOf(const std::vector<EarlierRecord>& found);

    /// What the item's run reads, as it was when this was first asked; none when it can't be read.
    const std::vector<KeptInput>& inputs(std::size_t item);
    /// They are looked at anew when asked for the next time.
    void forgetInputs(std::size_t item) { inputs_[item].reset(); }
    /// Those of inputs(), without checksums where they have changed since: nobody can tell whether
    /// a run has read them before or after that.
    std::vector<KeptInput> unchangedInputs(std::size_t item);

private:
    EarlierRecord look(std::size_t item, const PlannedRecord& planned, bool trustsTimes);
    std::string changeOfInputs(std::size_t item, const KeptRecord& record, bool trustsTimes);
    bool haveTimesOf(std::size_t item, const KeptRecord& record) const;
    std::string changeOfOutputs(const BatchItem& item, const KeptRecord& record,
                                const PlannedRecord& planned, bool trustsTimes) const;
    std::string placeOf(const BatchItem& item, const std::filesystem::path& input) const;

    const BatchProgram& program_;
    const BatchPlan& plan_;
    std::vector<std::optional<std::vector<KeptInput>>> inputs_;
};

}  // namespace adaptiso
