#include <gtest/gtest.h>

#include <algorithm>

#include "DicomBuilder.h"
#include "Fixtures.h"
#include "adaptiso/ImageIO/ListSeries.h"
#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::testing {
namespace {

namespace fs = std::filesystem;

DicomBuilder slice(int k) {
    return fieldSlice(tellTale, {1, 2, 3.0 + 2 * k});
}

void writeVolume(const fs::path& folder, int slices, const std::string& uid = "1.2.3.4") {
    fs::create_directories(folder);
    for (int k = 0; k < slices; ++k) {
        writeFile(folder / ("s" + std::to_string((k * 3) % 7)),
                  slice(k).text(0x0020000E, "UI", uid).file());
    }
}

/// One coronal image of another series.
DicomBuilder scout(const char* imageType) {
    DicomBuilder image = fieldSlice(tellTale, {0, 0, 0}, {1, 0, 0}, {0, 0, -1});
    image.text(0x0020000E, "UI", "9.9.1").text(0x00080008, "CS", imageType);
    return image;
}

std::int64_t slicesOf(const ReadVolume& read) {
    return read.volume.view().geometry().size[2];
}

bool mentions(const std::vector<Warning>& warnings, std::string_view text) {
    return std::ranges::any_of(warnings, [&](const Warning& warning) {
        return warning.text.find(text) != std::string::npos;
    });
}

TEST(DicomFolders, AreSearchedInTheirSubfolders) {
    const TempFolder folder;
    for (int k = 0; k < 6; ++k) {
        const fs::path part = folder / (k % 2 ? "a/deep/er" : "b");
        fs::create_directories(part);
        writeFile(part / std::to_string(k), slice(k).file());
    }
    const ReadVolume read = readVolume(folder.path());
    EXPECT_EQ(slicesOf(read), 6);
    EXPECT_TRUE(read.warnings.empty());
    expectField(read.volume, tellTale);
}

TEST(DicomFolders, LinksToFoldersAndHiddenOnesAreNotEntered) {
    const TempFolder folder;
    writeVolume(folder / "in", 3);
    writeVolume(folder / "in/.git", 3);                               // the same again
    fs::create_directory_symlink("..", folder / "in/up");             // a loop
    writeFile(folder / "in/._s0.dcm", std::string("\0\5\x16\7", 4));  // macOS leaves such beside
    const ReadVolume read = readVolume(folder / "in");
    EXPECT_EQ(slicesOf(read), 3);
    EXPECT_TRUE(mentions(read.warnings, "links to folders"));
}

TEST(DicomFolders, OneDamagedFileBelowIsRefused) {
    const TempFolder folder;
    writeVolume(folder / "in", 3);
    fs::create_directory(folder / "in/more");
    const std::string whole = slice(4).file();
    writeFile(folder / "in/more/x", whole.substr(0, whole.size() - 1));
    const std::string message = refusalOf(folder / "in");
    // before the slices s0, s3 and s6; its name may be a patient's
    EXPECT_TRUE(message.starts_with((folder / "in").native() + ": file 1 (by name): truncated"))
        << message;
}

TEST(DicomFolders, LinksToSlicesElsewhereAreRefusedWithoutTheirNames) {
    const TempFolder folder;
    writeVolume(folder / "in", 3);
    fs::rename(folder / "in/s3", folder / "secret");
    fs::create_symlink("../secret", folder / "in/s3");
    EXPECT_EQ(
        refusalOf(folder / "in"),
        (folder / "in").native() +
            ": file 2 (by name): is, or lies behind, a link to outside of its folder; put the "
            "file itself there");
    fs::create_directory(folder / "in/.store");
    fs::rename(folder / "secret", folder / "in/.store/kept");
    fs::remove(folder / "in/s3");
    fs::create_symlink(".store/kept", folder / "in/s3");
    EXPECT_EQ(slicesOf(readVolume(folder / "in")), 3);
}

TEST(DicomStrays, LocalizersAreLeftAsideAndNamed) {
    for (const char* type : {"ORIGINAL\\PRIMARY\\LOCALIZER", "DERIVED\\PRIMARY\\OTHER"}) {
        const TempFolder folder;
        writeVolume(folder.path(), 4);
        writeFile(folder / "0scout", scout(type).file());
        const ReadVolume read = readVolume(folder.path());
        expectField(read.volume, tellTale);
        EXPECT_EQ(slicesOf(read), 4);
        EXPECT_TRUE(mentions(read.warnings, "left aside: 1 slice of 4 x 3 voxels, coronal"));
        EXPECT_EQ(mentions(read.warnings, "localizer"), std::string(type).ends_with("LOCALIZER"));
        EXPECT_FALSE(mentions(read.warnings, "9.9.1") || mentions(read.warnings, "0scout"));
    }
}

TEST(DicomStrays, AScoutWithinTheSeriesIsLeftAside) {
    const TempFolder folder;
    writeVolume(folder.path(), 5);
    writeFile(folder / "x",
              scout("ORIGINAL\\PRIMARY\\LOCALIZER").text(0x0020000E, "UI", "1.2.3.4").file());
    EXPECT_EQ(slicesOf(readVolume(folder.path())), 5);
}

TEST(DicomStrays, ASurveyInThreeDirectionsIsLeftAside) {
    const TempFolder folder;
    writeVolume(folder.path(), 6);
    const std::vector<std::pair<Vec3, Vec3>> directions{
        {{1, 0, 0}, {0, 1, 0}}, {{1, 0, 0}, {0, 0, -1}}, {{0, 1, 0}, {0, 0, -1}}};
    for (std::size_t d = 0; d < 3; ++d) {
        const Vec3 normal = cross(directions[d].first, directions[d].second);
        for (int k = 0; k < 5; ++k) {
            DicomBuilder image =
                fieldSlice(tellTale, 10.0 * k * normal, directions[d].first, directions[d].second);
            image.text(0x0020000E, "UI", "5.5");
            writeFile(folder / ("survey" + std::to_string(5 * d + k)), image.file());
        }
    }
    const ReadVolume read = readVolume(folder.path());
    EXPECT_EQ(slicesOf(read), 6);
    EXPECT_EQ(read.warnings.size(), 3U);
    EXPECT_TRUE(mentions(read.warnings, "5 slices of 4 x 3 voxels, sagittal"));
}

TEST(DicomStrays, ColourImagesOfOtherSeriesAreLeftAside) {
    const TempFolder folder;
    writeVolume(folder.path(), 3);
    DicomBuilder image = scout("DERIVED\\SECONDARY");
    image.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.7").text(0x00280004, "CS", "RGB");
    image.us(0x00280002, 3).without(0x00200032).without(0x00200037);
    writeFile(folder / "shot", image.file());
    const ReadVolume read = readVolume(folder.path());
    EXPECT_EQ(slicesOf(read), 3);
    EXPECT_TRUE(mentions(read.warnings, "screenshot or colour"));
}

TEST(DicomStrays, NothingOfTheSameSeriesIsLeftAside) {
    const auto refused = [](DicomBuilder last, std::string_view fault) {
        const TempFolder folder;
        writeVolume(folder.path(), 4);
        writeFile(folder / "last", last.file());  // without it, four even slices
        const std::string message = refusalOf(folder.path());
        EXPECT_NE(message.find(fault), std::string::npos) << message;
    };
    refused(slice(4).us(0x00280010, 2).us(0x00280011, 2).pixels({1, 2, 3, 4}),
            "differ in series, size");
    refused(slice(4).text(0x00280030, "DS", "0.75\\0.6"), "differ in series, size");
    refused(slice(4).text(0x00200037, "DS", "0.9998\\0.02\\0\\-0.02\\0.9998\\0"), "differ in");
    refused(slice(4).us(0x00280100, 12), "pixel bits");
    refused(slice(4).text(0x00280004, "CS", "PALETTE COLOR"), "colour");
    refused(slice(4).without(0x00200037), "unknown orientation");
    refused(slice(4).without(0x00200032), "no ImagePositionPatient");
}

TEST(DicomStrays, AScreenshotWithinTheSeriesIsLeftAside) {
    const TempFolder folder;
    writeVolume(folder.path(), 4);
    DicomBuilder image = dicomImage(4, 3);  // of the slices' series, without a place
    image.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.7").text(0x00280004, "CS", "RGB");
    image.us(0x00280002, 3).us(0x00280100, 8).us(0x00280101, 8).us(0x00280102, 7);
    writeFile(folder / "dose", image.bytes(0x7FE00010, "OB", std::string(36, '\1')).file());
    const ReadVolume read = readVolume(folder.path());
    EXPECT_EQ(slicesOf(read), 4);
    EXPECT_TRUE(mentions(read.warnings, "left aside: 1 slice of 4 x 3 voxels"));
}

DicomBuilder objectWithoutPixels(const std::string& sopClass) {
    DicomBuilder object;
    object.text(0x00080008, "CS", "ORIGINAL\\PRIMARY")
        .text(0x00080016, "UI", sopClass)
        .text(0x00080060, "CS", "MR")
        .text(0x0020000E, "UI", "1.2.3.4");
    return object;
}

TEST(DicomStrays, ObjectsWithoutPixelsAreLeftAside) {
    const std::string storage = "1.2.840.10008.5.1.4.1.1.";
    // spectroscopy, CT protocol, report, dose report, key objects, presentation state, structures,
    // registration, raw data, a vendor's own
    for (const std::string& sopClass :
         {storage + "4.2", storage + "200.2", storage + "88.11", storage + "88.67",
          storage + "88.59", storage + "11.1", storage + "481.3", storage + "66.1", storage + "66",
          std::string("1.3.12.2.1107.5.9.1"), std::string("1.2.840.113619.4.27")}) {
        const TempFolder folder;
        writeVolume(folder.path(), 4);
        DicomBuilder object = objectWithoutPixels(sopClass);
        if (sopClass == storage + "4.2") object.us(0x00280010, 1).us(0x00280011, 1);
        writeFile(folder / "object.dcm", object.file());
        const ReadVolume read = readVolume(folder.path());
        EXPECT_EQ(slicesOf(read), 4) << sopClass;
        const bool isVendors = !sopClass.starts_with(storage);
        EXPECT_EQ(read.warnings.size(), isVendors ? 1U : 0U);
        EXPECT_EQ(mentions(read.warnings, "left aside: 1 DICOM file of a vendor's own kind"),
                  isVendors);
        EXPECT_EQ(listSeries(folder.path()).otherFiles, 1U);
    }
}

TEST(DicomStrays, ASliceThatLostItsPixelsIsNotLeftAside) {
    for (const char* sopClass :
         {"1.2.840.10008.5.1.4.1.1.2", "1.2.840.10008.5.1.4.1.1.4.1", "1.2.840.10008.5.1.4.1.1.128",
          "1.2.840.10008.5.1.4.1.1.66.4", "1.3.12.2.1107.5.9.1"}) {
        const TempFolder folder;
        writeVolume(folder.path(), 4);
        DicomBuilder object = objectWithoutPixels(sopClass);
        if (sopClass[2] == '3') object.us(0x00280010, 3);  // a vendor's, with Rows
        writeFile(folder / "object.dcm", object.file());
        expectRefusal(folder.path(), "without pixel data");
    }
}

// ---- what stands in a slice's place

constexpr const char* kLfsPointer =
    "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a4d\nsize 1346\n";

TEST(DicomStandIns, AreRefusedWhateverTheirNames) {
    const std::vector<std::pair<std::string, std::string>> contents{
        {kLfsPointer, "git lfs pull"},
        {"/annex/objects/SHA256E-s1346--4d7a4d\n", "git annex get"},
        {"<!DOCTYPE html><html><body>Log in</body></html>", "web page"},
        {std::string(5000, '\0'), "zeros"},
        {"", "empty file"}};
    for (const auto& [content, remedy] : contents) {
        for (const char* name : {"s9", "S9", "IM0003", "x.dcm", "1.2.840.7", "slice.0003"}) {
            const TempFolder folder;
            writeVolume(folder.path(), 4);
            writeFile(folder / name, content);
            const std::string message = refusalOf(folder.path());
            const int number = std::string(name) < "s0" ? 1 : 5;  // the slices: s0, s3, s6, s2
            EXPECT_TRUE(message.starts_with(folder.path().native() + ": file " +
                                            std::to_string(number) + " (by name): "))
                << message;
            EXPECT_NE(message.find(remedy), std::string::npos) << message;
            EXPECT_EQ(message.find('\n'), std::string::npos);
            const DicomListing listing = listSeries(folder.path());
            ASSERT_EQ(listing.damaged.size(), 1U);
            EXPECT_EQ(listing.damaged[0].fault.find(name), std::string::npos);
        }
    }
}

TEST(DicomStandIns, AreCounted) {
    const TempFolder folder;
    writeVolume(folder.path(), 2);
    for (const char* name : {"s7", "s8", "s9"}) writeFile(folder / name, kLfsPointer);
    const std::string message = refusalOf(folder.path());
    EXPECT_TRUE(message.starts_with(folder.path().native() +
                                    ": file 3 (by name) (3 such files): is a git-lfs"))
        << message;
}

TEST(DicomStandIns, OfCloudFoldersAreRefused) {
    const TempFolder folder;
    writeVolume(folder.path(), 4);
    writeFile(folder / ".notes.txt.icloud", "bplist00");
    EXPECT_EQ(slicesOf(readVolume(folder.path())), 4);
    writeFile(folder / ".s9.dcm.icloud", "bplist00");
    EXPECT_NE(refusalOf(folder.path()).find(": file 2 (by name): is a placeholder of iCloud"),
              std::string::npos);
}

TEST(DicomStandIns, WhatIsNamedLikeTheSlicesMustBeDicom) {
    const TempFolder folder;
    writeVolume(folder.path(), 4);
    writeFile(folder / "s7", "no DICOM");
    expectRefusal(folder.path(), "named like a DICOM file but is not one");
    fs::remove(folder / "s7");
    fs::create_directory(folder / "sub");
    writeFile(folder / "sub/s7", "no DICOM");  // not beside them
    EXPECT_EQ(slicesOf(readVolume(folder.path())), 4);
}

TEST(DicomStandIns, FilesThatLieInFoldersAreLeftAside) {
    const TempFolder folder;
    writeVolume(folder.path(), 4);
    for (const char* name : {"notes.txt", "a.json", "Thumbs.db", ".DS_Store", "photo.JPG", "x.pdf",
                             "README", "LICENSE", "index.html", "mask.nii.gz", "._s9"}) {
        writeFile(folder / name, name[0] == 'R' ? "" : kLfsPointer);
    }
    writeFile(folder / "viewer",
              "\x7f"
              "ELF");
    const ReadVolume read = readVolume(folder.path());
    EXPECT_EQ(slicesOf(read), 4);
    EXPECT_TRUE(read.warnings.empty());
}

TEST(DicomStandIns, AFolderOfPointersAloneSaysSo) {
    const TempFolder folder;
    writeFile(folder / "IM1", kLfsPointer);
    writeFile(folder / "IM2", kLfsPointer);
    EXPECT_NE(refusalOf(folder.path()).find("git lfs pull"), std::string::npos);
}

TEST(DicomStrays, TwoVolumesAreForTheUserToChoose) {
    const TempFolder folder;
    writeVolume(folder / "a", 3);
    writeVolume(folder / "b", 4, "7.7");
    const std::string message = refusalOf(folder.path());
    EXPECT_NE(message.find("--series"), std::string::npos) << message;
    for (const ReadOptions& options : {ReadOptions{}, ReadOptions{.series = "3"}}) {
        try {
            readVolume(folder.path(), options);
            ADD_FAILURE();
        } catch (const ChoiceNeeded& choice) {
            EXPECT_EQ(choice.among(), ChoiceNeeded::Among::Series);
            EXPECT_EQ(choice.count(), 2);
        }
    }
    EXPECT_EQ(slicesOf(readVolume(folder.path(), {.series = "2"})), 4);
    EXPECT_EQ(slicesOf(readVolume(folder.path(), {.series = "1.2.3.4"})), 3);
}

// ---- DICOMDIR

std::string directoryOf(const std::vector<std::string>& names) {
    std::vector<DicomBuilder> records(1);  // a record without a file: the patient's
    records[0].text(0x00041430, "CS", "PATIENT").text(0x00100010, "PN", "Secret^Patient");
    for (const std::string& name : names) {
        records.emplace_back().text(0x00041430, "CS", "IMAGE").text(0x00041500, "CS", name);
    }
    DicomBuilder directory;
    directory.text(0x00080016, "UI", "1.2.840.10008.1.3.10").sequence(0x00041220, records);
    return directory.file();
}

TEST(DicomDirectory, NamesTheSlicesThatAreRead) {
    const TempFolder folder;
    std::vector<std::string> names;
    fs::create_directories(folder / "images/low");
    for (int k = 0; k < 4; ++k) {
        names.push_back("IMAGES\\LOW\\I" + std::to_string(k));
        // media copied by other systems come out in small letters
        writeFile(folder / ("images/low/i" + std::to_string(k)), slice(k).file());
    }
    writeFile(folder / "images/low/other", slice(9).file());  // not named
    const ReadVolume read = readVolume(writeFile(folder / "DICOMDIR", directoryOf(names)));
    EXPECT_EQ(slicesOf(read), 4);
    expectField(read.volume, tellTale);
}

TEST(DicomDirectory, BesideTheSlicesDoesNotDisturb) {
    const TempFolder folder;
    writeVolume(folder / "I", 3);
    writeFile(folder / "DICOMDIR", directoryOf({"I\\S0"}));
    EXPECT_EQ(slicesOf(readVolume(folder.path())), 3);
}

TEST(DicomDirectory, MayNotLeaveItsFolderNorNameWhatIsMissing) {
    const TempFolder folder;
    writeVolume(folder / "I", 3);
    fs::create_directory(folder / "sub");
    const fs::path directory = folder / "sub/DICOMDIR";
    for (const char* name : {"..\\I\\S0", "I/S0", "\\I", "."}) {
        expectRefusal(writeFile(directory, directoryOf({name})), "outside its own folder");
    }
    expectRefusal(writeFile(directory, directoryOf({"GONE"})), "not there (GONE)");
    writeFile(folder / "sub/POINTER", kLfsPointer);
    writeFile(directory, directoryOf({"POINTER"}));
    EXPECT_NE(refusalOf(directory).find("git lfs pull"), std::string::npos);
    expectRefusal(writeFile(directory, directoryOf({})), "no DICOM file found in this DICOMDIR");
}

// ---- listSeries

TEST(ListSeries, SaysWhatAFolderHolds) {
    const TempFolder folder;
    writeVolume(folder / "a", 3);
    for (const int k : {0, 1, 3}) {
        writeFile(folder / ("b" + std::to_string(k)),
                  slice(k).text(0x0020000E, "UI", "7.7").text(0x00080060, "CS", "MR").file());
    }
    writeFile(folder / "c", scout("ORIGINAL\\PRIMARY\\LOCALIZER").file());
    writeFile(folder / "d.dcm", "no DICOM");
    const DicomListing listing = listSeries(folder.path());
    ASSERT_EQ(listing.series.size(), 3U);
    const DicomSeries& first = listing.series[0];
    EXPECT_EQ(first.number, 1);
    EXPECT_EQ(first.uid, "1.2.3.4");
    EXPECT_EQ(first.description, "Secret^Description");
    EXPECT_EQ(first.modality, "CT");
    EXPECT_EQ(first.orientation, "axial");
    EXPECT_EQ(first.columns, 4);
    EXPECT_EQ(first.rows, 3);
    EXPECT_EQ(first.slices, 3);
    EXPECT_EQ(first.volumes, 1);
    EXPECT_EQ(first.spacingMm, (Vec3{0.5, 0.75, 2}));
    EXPECT_TRUE(first.isReadable()) << first.fault;
    EXPECT_EQ(listing.series[1].modality, "MR");
    EXPECT_TRUE(listing.series[1].fault.starts_with("uneven slice spacing: 4 mm between slices 2"))
        << listing.series[1].fault;
    EXPECT_TRUE(listing.series[2].isLocalizer);
    EXPECT_FALSE(listing.series[2].isReadable());
    ASSERT_EQ(listing.damaged.size(), 1U);
    EXPECT_EQ(listing.damaged[0].file, folder / "d.dcm");
    EXPECT_EQ(listing.damaged[0].fault.find("d.dcm"), std::string::npos);
}

TEST(ListSeries, FaultsHoldNoFileNames) {
    const TempFolder folder;
    fs::create_directories(folder / "in");
    for (int k = 0; k < 3; ++k) {
        DicomBuilder image = slice(k);
        if (k == 1) image.without(0x00200032);
        writeFile(folder / ("in/PHI" + std::to_string(k)), image.file());
        writeFile(folder / ("in/PHIrgb" + std::to_string(k)),
                  slice(k).text(0x0020000E, "UI", "8").text(0x00280004, "CS", "RGB").file());
    }
    writeFile(folder / "in/PHIcopy", slice(0).text(0x0020000E, "UI", "7").file());
    writeFile(folder / "in/PHIcopy2", slice(0).text(0x0020000E, "UI", "7").file());
    writeFile(folder / "in/PHIcopy3", slice(1).text(0x0020000E, "UI", "7").file());
    const DicomListing listing = listSeries(folder / "in");
    ASSERT_EQ(listing.series.size(), 3U);
    for (const DicomSeries& series : listing.series) {
        EXPECT_FALSE(series.isReadable());
        EXPECT_EQ(series.fault.find("PHI"), std::string::npos) << series.fault;
    }
}

TEST(ListSeries, RefusesWhatIsNoDicom) {
    const TempFolder folder;
    EXPECT_THROW(listSeries(folder.path()), FileError);
    EXPECT_THROW(listSeries(writeFile(folder / "x.nii", NiftiFile().bytes())), FileError);
    EXPECT_THROW(listSeries(folder / "missing"), FileError);
}

}  // namespace
}  // namespace adaptiso::testing
