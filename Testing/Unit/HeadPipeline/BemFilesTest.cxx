#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "BemFileKinds.h"
#include "Support/Meshes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/HeadPipeline/BemFiles.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;
using testing::icosphere;

/// Three spheres with all that a folder can hold.
/// \param movedMm  all of it along x
BemModel wholeModel(double movedMm, bool onGrid) {
    const Vec3 middle{movedMm, 0, 0};
    BemModel model;
    model.image = ImageGeometry{{200, 200, 200}, {-100, -100, -100}, Mat3{}};
    model.tkRasVolume = model.image;
    for (const double radius : {60.0, 66.0, 72.0}) {
        model.meshes.push_back(icosphere(2, middle, radius));
    }
    model.surfaces.resize(3);
    model.spongyBone.emplace().mesh = icosphere(2, middle + Vec3{0, 0, 63}, 2);
    model.options.conductivities.skull = 0.006 + 0.0001 * movedMm;
    model.headShape = HeadShape{icosphere(2, middle, 72), icosphere(1, middle, 72)};
    BemElectrodes& electrodes = model.electrodes.emplace();
    const Vec3 head = 2 * middle;  // else nothing moves in frames that landmarks span
    electrodes.landmarks =
        Landmarks{head + Vec3{0, -72, 0}, head + Vec3{72, 0, 0}, head + Vec3{-72, 0, 0}};
    electrodes.points = {{"Cz", PointKind::Electrode, middle + Vec3{0, 0, 72}},
                         {"O 2:b", PointKind::Electrode, middle + Vec3{0, 72, 0}}};
    BemSources& sources = model.sources.emplace();
    sources.spaces.push_back(onGrid ? gridSources(model.meshes.front(), 20)
                                    : surfaceSources(icosphere(2, middle, 40), 20));
    if (onGrid) {
        for (Vec3& p : sources.spaces.front().surface.points) p += middle;
        sources.spaces.front().grid->originMm += middle;
    }
    const auto numbers = static_cast<std::size_t>(2 * sources.dipoles());
    model.leadField =
        BemLeadField{"MNE", std::vector<double>(numbers, movedMm), std::to_string(movedMm)};
    TetrahedralMesh& mesh = model.tetrahedra.emplace().mesh;
    mesh.points = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0, 10}, {10, 10, 10}};
    for (Vec3& p : mesh.points) p += middle;
    mesh.tetrahedra = {{0, 1, 2, 3}, {1, 2, 3, 4}};
    mesh.labels = {5, 2};
    return model;
}

BemFileOptions allFiles() {
    BemFileOptions options;
    options.writesGifti = options.writesVtp = options.writesFif = options.writesBrainstorm = true;
    options.writesSimNibs = options.writesBesa = options.writesFieldTrip = true;
    options.writesBemFmm = true;
    return options;
}

class BemFiles : public ::testing::TestWithParam<bool> {
protected:
    BemFiles()
        : folder_(fs::path(::testing::TempDir()) / ("BemFiles" + std::to_string(::getpid()))),
          model_(wholeModel(0, GetParam())) {
        fs::remove_all(folder_);
        write(model_, "model");
        write(wholeModel(kMovedMm, GetParam()), "other");
    }
    ~BemFiles() override { fs::remove_all(folder_); }

    void write(const BemModel& model, const std::string& name) {
        const fs::path folder = folder_ / name;
        fs::create_directories(folder);
        writeBemFiles(model, allFiles(), "test",
                      [&](const std::string& file) { return folder / file; });
    }

    bool isFound(const BemFileRow& row) const {
        const BemFileOptions options = allFiles();
        try {
            return row.kind({model_, options}, row.files).check(folder_ / "model").has_value();
        } catch (const FileError&) {
            return true;
        }
    }

    /// Damages each file of each row, and expects its check to fail.
    void expectFound(const std::function<bool(const fs::path& file)>& damage) {
        for (const BemFileRow& row : bemFileRows()) {
            for (const std::string& name : row.files) {
                const fs::path file = folder_ / "model" / name, kept = folder_ / "kept";
                if (!fs::exists(file)) continue;
                fs::copy_file(file, kept, fs::copy_options::overwrite_existing);
                EXPECT_TRUE(!damage(file) || isFound(row)) << name;
                fs::copy_file(kept, file, fs::copy_options::overwrite_existing);
            }
        }
    }

    static constexpr double kMovedMm = 0.01;  // ten times what rounding may take
    fs::path folder_;
    BemModel model_;
};

TEST_P(BemFiles, AreReadBackOfEveryRow) {
    BemModel model = model_;
    checkBemFiles(folder_ / "model", allFiles(), model);
    EXPECT_EQ(model.checks.size(), bemFileRows().size());
    for (const BemCheck& check : model.checks) EXPECT_TRUE(check.isPassed) << check.detail;
    EXPECT_TRUE(model.hasModel());
    const std::vector<std::string> names = bemFileNames();
    for (const auto& entry : fs::directory_iterator(folder_ / "model")) {
        const std::string name = entry.path().filename().string();
        EXPECT_EQ(std::ranges::count(names, name), 1) << name;
    }
}

TEST_P(BemFiles, ThatCannotBeReadAreFindings) {
    fs::resize_file(folder_ / "model" / "head.vtu", 500);
    BemModel model = model_;
    checkBemFiles(folder_ / "model", allFiles(), model);
    ASSERT_EQ(model.findings.size(), 1u);
    EXPECT_TRUE(model.findings[0].what.starts_with("head.vtu: the same when read back: head.vtu: "))
        << model.findings[0].what;
}

TEST_P(BemFiles, OfAnotherModelAreFound) {
    expectFound([&](const fs::path& file) {
        if (file.filename() == "model.geom") return false;  // names its surfaces alone
        fs::copy_file(folder_ / "other" / file.filename(), file,
                      fs::copy_options::overwrite_existing);
        return true;
    });
}

TEST_P(BemFiles, CutShortAreFound) {
    expectFound([](const fs::path& file) {
        fs::resize_file(file, fs::file_size(file) / 2);
        return true;
    });
}

TEST_P(BemFiles, MissingOnesAreFound) {
    expectFound([](const fs::path& file) {
        return file.filename() != "coordsystem.json" && fs::remove(file);
    });
}

INSTANTIATE_TEST_SUITE_P(SourcesOf, BemFiles, ::testing::Bool(),
                         [](const auto& row) { return row.param ? "Grid" : "Cortex"; });

}  // namespace
}  // namespace adaptiso
