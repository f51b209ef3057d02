#include <deque>
#include <iostream>
#include <string>

#include "Common/AtomicOutput.h"
#include "Common/RunApp.h"
#include "Common/Verdict.h"
#include "Levels.h"
#include "Products.h"

namespace adaptiso {
namespace {

constexpr const char* kProgram = "adaptiso-bids";

/// How the runs of all batches ended.
struct Ends {
    bool haveFailed = false, wereRefused = false;
    bool haveBroken = false;        ///< by a bug
    bool mayPassElsewhere = false;  ///< killed, not started, or short of memory or disk

    void add(const BatchRecord& record) {
        haveFailed = haveFailed || !record.hasPassed();
        mayPassElsewhere = mayPassElsewhere || adaptiso::mayPassElsewhere(record);
        haveBroken = haveBroken || (record.signal == 0 && record.exitCode == kExitInternalError);
        wereRefused = wereRefused || (record.signal == 0 && record.exitCode == kExitUsage);
    }
    int code() const {
        return wereRefused        ? kExitUsage
               : haveBroken       ? kExitInternalError
               : mayPassElsewhere ? kExitBadInput
               : haveFailed       ? kExitCheckFailed
                                  : kExitOk;
    }
};

void tellFailed(const std::string& subject, const std::string& reason, const CommonOptions& common,
                Ends& ends) {
    ends.haveFailed = true;
    if (common.isQuiet || common.wantsJsonOnStdout()) {
        printError(kProgram, "failed: " + subject + ": " + reason);
    } else {
        std::cout << "FAILED  " << subject << ": " << reason << std::endl;
    }
}

void run(Product& product, const CommonOptions& common, std::string& lines, Ends& ends) {
    for (const std::string& subject : product.without) {
        tellFailed(subject, product.name + ": no " + product.needs, common, ends);
    }
    if (product.items.empty()) return;
    product.program.jsonLines = &lines;
    product.program.ended = [&ends](const BatchItem&, const BatchRecord& record) {
        ends.add(record);
    };
    const int code = runBatch(product.program, product.batch, common);
    ends.haveFailed = ends.haveFailed || code != kExitOk;  // of earlier runs, too
}

}  // namespace

int runParticipants(const BidsOptions& options, const ChosenSubjects& chosen) {
    const bool writesJson = options.common.wantsJson() && !options.common.wantsJsonOnStdout();
    if (writesJson) checkOutput(options.common.json);
    std::deque<Product> products = findProducts(options, chosen.folders);
    Ends ends;
    for (const auto& [subject, reason] : chosen.faulty) {
        tellFailed(subject, reason, options.common, ends);
    }
    std::string lines;
    for (Product& product : products) run(product, options.common, lines, ends);
    if (options.makesChecks) {
        products.push_back(checkOf(options, products.front()));
        bindItems(products.back());
        run(products.back(), options.common, lines, ends);
    }
    if (writesJson) {
        std::vector<AtomicOutput> outputs;
        outputs.emplace_back(options.common.json).writeText(lines);
        AtomicOutput::commit(outputs);
    }
    flushResults();
    return ends.code();
}

}  // namespace adaptiso
