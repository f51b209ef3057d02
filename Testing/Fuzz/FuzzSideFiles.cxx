// libFuzzer target: small files of text beside the data: --list, participants.tsv, .bidsignore and
// dataset_description.json. The first byte chooses. A text is refused in one line, or gives what
// the reader's header promises.

#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "Common/Batch.h"
#include "OneLine.h"
#include "adaptiso-bids/SideFiles.h"
#include "adaptiso/Core/Errors.h"

namespace {

using adaptiso::BatchItem;

void tryList(std::string_view text, bool areHeads) {
    const auto nameOf = [](const std::filesystem::path& file) { return file.stem().string(); };
    for (const BatchItem& item : adaptiso::listedItems(text, "--list x", areHeads, nameOf)) {
        if (item.inputs.empty() || item.inputs.front().empty()) std::abort();
        if (item.name.find('/') != item.name.npos) std::abort();
    }
}

void tryIgnore(std::string_view text) {
    const adaptiso::bids::BidsIgnore ignored(text);
    for (const char* const path :
         {"sub-01",
          "sub-01/ses-a/anat/sub-01_ses-a_acq-aaaaaaaaaaaaaaaaaaaaaaaaaaaaab_T1w.nii.gz"}) {
        (void)ignored.contains(path);
    }
}

void tryText(std::uint8_t file, std::string_view text) {
    if (file % 5 < 2) {
        tryList(text, file % 5 == 1);
    } else if (file % 5 == 2) {
        for (const std::string& id : adaptiso::bids::participantsIn(text)) {
            if (!id.starts_with("sub-")) std::abort();
        }
        for (const auto& [id, years] : adaptiso::bids::agesIn(text, {})) {
            if (!id.starts_with("sub-") || !(years >= 0 && years <= 120)) std::abort();
        }
    } else if (file % 5 == 3) {
        tryIgnore(text);
    } else {
        (void)adaptiso::bids::missingKeyOf(text);
        (void)adaptiso::bids::agesIn("participant_id\tage\n01\t9\n", text);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    try {
        tryText(data[0], {reinterpret_cast<const char*>(data) + 1, size - 1});
    } catch (const adaptiso::Error& refusal) {
        adaptiso::fuzz::requireOneLine(refusal);
    }
    return 0;
}
