#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace adaptiso::fuzz {

/// What fuzzing begins with: small sound files of every kind, in one folder for each target.
class Seeds {
public:
    explicit Seeds(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// \throws FileError  the disk is full
    void add(const std::string& target, std::string_view bytes);

private:
    std::filesystem::path folder_;
    std::map<std::string, int> counts_;
};

void addImageSeeds(Seeds& seeds);
void addDicomSeeds(Seeds& seeds);
void addMeshSeeds(Seeds& seeds);
void addZarrSeeds(Seeds& seeds);
void addSandboxSeeds(Seeds& seeds);
void addIndexSeeds(Seeds& seeds);
void addOpenMeegSeeds(Seeds& seeds);
void addLabelSeeds(Seeds& seeds);
void addGiantSeeds(Seeds& seeds);
void addMesherSeeds(Seeds& seeds);

}  // namespace adaptiso::fuzz
