#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <new>
#include <numeric>
#include <thread>

#include "Fixtures.h"
#include "Samples.h"
#include "Sandbox.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::testing {
namespace {

using detail::readInSandbox;
using detail::SandboxAnswer;
using detail::SandboxLimits;
using namespace std::chrono_literals;

// a second is far more than these reads take, also under a sanitizer on a busy machine
constexpr SandboxLimits kRoomy{30s, std::uint64_t{1} << 30};
const std::filesystem::path kInput = "folder/x.dcm";

const ImageGeometry kGeometry{{4, 3, 2}, {1, 2, 3}, Mat3{{{{2, 0, 0}, {0.5, 3, 0}, {0, 1, -4}}}}};

ReadVolume made(const std::shared_ptr<std::byte[]>& samples) {
    const auto values = countingSamples<std::int16_t>(24);
    std::memcpy(samples.get(), values.data(), 48);
    return {detail::makeVolume(samples, PixelType::Int16, kGeometry),
            "DICOM",
            {{"odd-one", "one"}, {"odd-two", "two"}}};
}

/// The message of the FileError; fails the test when there is none.
std::string refusal(const std::function<ReadVolume()>& read, const SandboxLimits& limits = kRoomy) {
    try {
        readInSandbox(kInput, limits, read);
    } catch (const FileError& error) {
        return error.what();
    }
    ADD_FAILURE() << "it was read, must be refused";
    return {};
}

TEST(Sandbox, OpensFilesBelowItsPlacesAlone) {
    const TempFolder folder;
    const auto inside = folder / "in", outside = folder / "out";
    std::filesystem::create_directories(inside / "deep");
    std::filesystem::create_directories(outside);
    writeFile(inside / "deep/a", "a");
    writeFile(outside / "b", "b");
    std::filesystem::create_symlink(outside / "b", inside / "link");
    std::filesystem::create_symlink(inside / "deep/a", outside / "back");
    const auto opens = [](const std::filesystem::path& file) {
        return std::ifstream(file).good() ? '1' : '0';
    };
    const std::string found = refusal([&]() -> ReadVolume {
        std::string text;
        if (!detail::openOnlyBelow({inside, folder / "missing"})) throw FileError("no Landlock");
        for (const auto& file : {inside / "deep/a", outside / "back", inside / "link",
                                 outside / "b", inside / "../out/b"}) {
            text += opens(file);
        }
        text += std::ofstream(inside / "new").good() ? '1' : '0';
        throw FileError(text);
    });
    if (found == "no Landlock") GTEST_SKIP() << found;
    EXPECT_EQ(found, "110000");
    EXPECT_EQ(opens(outside / "b"), '1');  // this process is as free as before
}

void expectOneLine(const std::string& message, std::string_view fault) {
    EXPECT_TRUE(message.starts_with("folder/x.dcm: ")) << message;
    EXPECT_NE(message.find(fault), std::string::npos) << message << "\nwanted: " << fault;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

void expectNoChildLeft() {
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
    EXPECT_EQ(errno, ECHILD);
}

TEST(Sandbox, HandsTheVolumeBackWhole) {
    const ReadVolume result =
        readInSandbox(kInput, kRoomy, [] { return made(detail::allocateSamples(kInput, 48)); });
    EXPECT_EQ(samplesIn<std::int16_t>(result.volume), countingSamples<std::int16_t>(24));
    EXPECT_EQ(result.volume.view().geometry(), kGeometry);
    EXPECT_EQ(result.format, "DICOM");
    EXPECT_EQ(result.warnings, (std::vector<Warning>{{"odd-one", "one"}, {"odd-two", "two"}}));
    expectNoChildLeft();
}

TEST(Sandbox, TakesSamplesFromWhereverTheyLie) {
    const ReadVolume fromHeap = readInSandbox(kInput, kRoomy, [] {
        return ReadVolume{
            Volume::fromSamples(countingSamples<std::int16_t>(24), kGeometry), "x", {}};
    });
    EXPECT_EQ(samplesIn<std::int16_t>(fromHeap.volume), countingSamples<std::int16_t>(24));
    const ReadVolume fromSecondBlock = readInSandbox(kInput, kRoomy, [] {
        const auto first = detail::allocateSamples(kInput, 5000);
        { const auto given = detail::allocateSamples(kInput, 9000); }
        return made(detail::allocateSamples(kInput, 48));
    });
    EXPECT_EQ(samplesIn<std::int16_t>(fromSecondBlock.volume), countingSamples<std::int16_t>(24));
}

TEST(Sandbox, KeepsSamplesAsLongAsTheVolumeLives) {
    std::optional<Volume> kept;
    {
        const ReadVolume result =
            readInSandbox(kInput, kRoomy, [] { return made(detail::allocateSamples(kInput, 48)); });
        kept = result.volume;
    }
    EXPECT_EQ(samplesIn<std::int16_t>(*kept), countingSamples<std::int16_t>(24));
}

TEST(Sandbox, PassesTheLibrarysErrorsOn) {
    EXPECT_EQ(refusal([]() -> ReadVolume { throw FileError("slice 3: is odd"); }),
              "slice 3: is odd");
    EXPECT_THROW(readInSandbox(kInput, kRoomy, []() -> ReadVolume { throw InvalidInput("x"); }),
                 InvalidInput);
    EXPECT_THROW(readInSandbox(kInput, kRoomy, []() -> ReadVolume { throw InternalError("x"); }),
                 InternalError);
    expectOneLine(refusal([]() -> ReadVolume { throw std::runtime_error("a.cxx:7:\nthis=0x5"); }),
                  "can't be decoded");
    expectOneLine(refusal([]() -> ReadVolume { throw 5; }), "can't be decoded");
    expectNoChildLeft();
}

TEST(Sandbox, TurnsEveryDeathIntoOneLine) {
    expectOneLine(refusal([]() -> ReadVolume { std::abort(); }), "crashed (signal 6");
    expectOneLine(refusal([]() -> ReadVolume { ::raise(SIGSEGV), std::abort(); }),
                  "crashed (signal 11");
    expectOneLine(refusal([]() -> ReadVolume { ::raise(SIGFPE), std::abort(); }), "crashed");
    expectOneLine(refusal([]() -> ReadVolume { ::raise(SIGKILL), std::abort(); }), "memory");
    expectOneLine(refusal([]() -> ReadVolume { std::terminate(); }), "crashed (signal 6");
    expectOneLine(refusal([]() -> ReadVolume { std::_Exit(7); }), "ended early (exit code 7)");
    expectOneLine(refusal([]() -> ReadVolume { std::_Exit(0); }), "ended early (exit code 0)");
    expectNoChildLeft();
}

volatile int deepest = 1 << 30;  // so that the compiler sees an end

/// Each frame is used after the call and through the callee, so that none can be merged.
int recurse(volatile char* outer, int depth) {
    volatile char frame[4096] = {};
    frame[0] = *outer;
    const int inner = depth < deepest ? recurse(frame, depth + 1) : 0;
    return inner + frame[0];
}

TEST(Sandbox, TurnsStackOverflowIntoOneLine) {
    const std::string message = refusal([]() -> ReadVolume {
        volatile char start = 0;
        std::_Exit(recurse(&start, 0));
    });
#ifndef ADAPTISO_SANITIZED  // a sanitizer ends the process in its own way
    expectOneLine(message, "crashed (signal 11");
#endif
    EXPECT_TRUE(message.starts_with("folder/x.dcm: ")) << message;
}

TEST(Sandbox, StopsWhatDoesNotEnd) {
    const SandboxLimits hasty{300ms, kRoomy.memoryBytes};
    const auto begin = std::chrono::steady_clock::now();
    expectOneLine(refusal(
                      []() -> ReadVolume {
                          for (volatile bool goesOn = true; goesOn;) {
                          }
                          std::abort();
                      },
                      hasty),
                  "stopped after ");  // by the clock where others take the processors
    expectOneLine(refusal(
                      []() -> ReadVolume {
                          for (;;) ::pause();
                      },
                      hasty),
                  "stopped");
    // signals that a decoder's library might block or ignore do not help it
    expectOneLine(refusal(
                      []() -> ReadVolume {
                          sigset_t all;
                          sigfillset(&all);
                          sigprocmask(SIG_BLOCK, &all, nullptr);
                          for (;;) ::pause();
                      },
                      hasty),
                  "stopped");
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 20s);
    expectNoChildLeft();
}

TEST(Sandbox, BoundsMemory) {
#ifdef ADAPTISO_SANITIZED
    GTEST_SKIP() << "sanitizers end the process when memory is short";
#endif
    const SandboxLimits small{30s, std::uint64_t{64} << 20};
    const auto hoard = []() -> ReadVolume {
        std::vector<std::vector<std::byte>> blocks;
        for (;;) blocks.emplace_back(std::size_t{1} << 20, std::byte{1});
    };
    expectOneLine(refusal(hoard, small), "memory");
    expectOneLine(refusal([]() -> ReadVolume {
                      return made(detail::allocateSamples(kInput, std::uint64_t{1} << 50));
                  }),
                  "memory");
    // 32 MB beyond what the parent has, which counts for nothing
    const std::vector<std::byte> parents(std::size_t{128} << 20, std::byte{1});
    EXPECT_EQ(readInSandbox(kInput, small,
                            [] {
                                const std::vector<std::byte> some(std::size_t{32} << 20,
                                                                  std::byte{1});
                                return made(detail::allocateSamples(kInput, 48));
                            })
                  .format,
              "DICOM");
}

TEST(Sandbox, NamesTheFileThatTheDecoderWasGiven) {
    EXPECT_TRUE(refusal([]() -> ReadVolume {
                    detail::blameInSandbox("folder/longer-name.dcm");
                    detail::blameInSandbox("folder/y.dcm");
                    std::abort();
                }).starts_with("folder/y.dcm: its decoder crashed"));
}

/// Overwrites the answer's end of the pipe and whatever else may be open for writing.
[[noreturn]] void answer(std::string_view bytes) {
    for (int file = 3; file < 64; ++file) {
        if (::lseek(file, 0, SEEK_CUR) >= 0) continue;  // the shared memory
        (void)!::write(file, bytes.data(), bytes.size());
    }
    std::_Exit(0);
}

TEST(Sandbox, BelievesNoGarbage) {
    const std::string noise(5000, '\xA5');
    SandboxAnswer lie{SandboxAnswer::Kind::Volume, "", PixelType::Int16, kGeometry, 0, 48, "x", {}};
    const std::string promisesSamplesThatAreNotThere = packSandboxAnswer(lie);
    for (const std::string& bytes : {noise, std::string(3, '\0'), promisesSamplesThatAreNotThere,
                                     promisesSamplesThatAreNotThere.substr(0, 100),
                                     std::string(detail::kLongestAnswer + 5, '\1')}) {
        expectOneLine(refusal([&]() -> ReadVolume { answer(bytes); }), "nonsense");
    }
    const auto liesAfterAllocating = [&](const SandboxAnswer& told) {
        return refusal([&]() -> ReadVolume {
            const auto samples = detail::allocateSamples(kInput, 48);
            answer(packSandboxAnswer(told));
        });
    };
    SandboxAnswer outside = lie;
    outside.offset = ~std::uint64_t{0} - 10;
    expectOneLine(liesAfterAllocating(outside), "nonsense");
    SandboxAnswer tooShort = lie;
    tooShort.byteCount = 46;
    expectOneLine(liesAfterAllocating(tooShort), "nonsense");
    SandboxAnswer huge = lie;
    huge.geometry.size = {1 << 30, 1 << 30, 1 << 30};
    EXPECT_TRUE(liesAfterAllocating(huge).starts_with("folder/x.dcm: "));
    SandboxAnswer flat = lie;
    flat.geometry.indexToPhysical.column[1] = flat.geometry.indexToPhysical.column[0];
    expectOneLine(liesAfterAllocating(flat), "singular");
    SandboxAnswer escape{
        SandboxAnswer::Kind::FileError, "folder/x.dcm: \x1b[2J\n", {}, {}, 0, 0, "", {}};
    expectOneLine(liesAfterAllocating(escape), "folder/x.dcm:  [2J");
    expectNoChildLeft();
}

TEST(SandboxAnswer, ParsesOnlyWholeAnswers) {
    const SandboxAnswer told{SandboxAnswer::Kind::Volume,
                             "",
                             PixelType::Float64,
                             kGeometry,
                             4096,
                             192,
                             "DICOM",
                             {{"gantry-tilt", "tilted"}, {"stray-bits", "odd"}},
                             "RescaleSlope 2, RescaleIntercept 0"};
    const std::string bytes = packSandboxAnswer(told);
    const auto parsed = detail::parseSandboxAnswer(bytes);
    ASSERT_TRUE(parsed);
    EXPECT_EQ(parsed->geometry, kGeometry);
    EXPECT_EQ(parsed->pixelType, PixelType::Float64);
    EXPECT_EQ(parsed->offset, 4096U);
    EXPECT_EQ(parsed->byteCount, 192U);
    EXPECT_EQ(parsed->format, "DICOM");
    EXPECT_EQ(parsed->warnings, told.warnings);
    EXPECT_EQ(parsed->scaling, told.scaling);
    for (std::size_t length = 0; length < bytes.size(); ++length) {
        EXPECT_FALSE(detail::parseSandboxAnswer(std::string_view(bytes).substr(0, length)));
    }
    EXPECT_FALSE(detail::parseSandboxAnswer(bytes + "x"));
    // any one byte wrong: no crash, and never a text beyond the answer
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        std::string damaged = bytes;
        damaged[i] = static_cast<char>(damaged[i] ^ 0xff);
        (void)detail::parseSandboxAnswer(damaged);
    }
}

TEST(Sandbox, SilencesTheDecoder) {
    ::testing::internal::CaptureStderr();
    ::testing::internal::CaptureStdout();
    readInSandbox(kInput, kRoomy, [] {
        (void)!::write(STDERR_FILENO, "noise", 5);
        (void)!::write(STDOUT_FILENO, "noise", 5);
        std::fprintf(stderr, "noise");
        std::fflush(stderr);
        return made(detail::allocateSamples(kInput, 48));
    });
    EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(Sandbox, GivesTheDecoderNoFileOfTheCallers) {
    const TempFolder folder;
    const auto file = writeFile(folder / "output", "precious");
    std::ofstream output(file, std::ios::app);
    output << "unwritten";  // in the stream's buffer, which the child must not flush
    readInSandbox(kInput, kRoomy, [] {
        for (int number = 3; number < 1024; ++number) {
            if (::lseek(number, 0, SEEK_CUR) >= 0 && ::ftruncate(number, 1 << 20) == 0) continue;
        }
        return made(detail::allocateSamples(kInput, 48));
    });
    EXPECT_EQ(std::filesystem::file_size(file), 8U);
}

std::atomic<int> handled{0};
void countSignal(int) {
    ++handled;
}

TEST(Sandbox, LeavesTheCallersSignalHandlersAlone) {
    struct sigaction action {
    }, before{};
    action.sa_handler = countSignal;
    sigaction(SIGTERM, &action, &before);
    handled = 0;
    // in the child SIGTERM ends it, the caller's handler does not run there
    expectOneLine(refusal([]() -> ReadVolume {
                      ::raise(SIGTERM);
                      std::_Exit(3);
                  }),
                  "interrupted (signal 15)");
    // in the parent it does, and reading goes on
    const pid_t self = ::getpid();
    const ReadVolume result = readInSandbox(kInput, kRoomy, [self] {
        for (int i = 0; i < 5; ++i) {
            ::kill(self, SIGTERM);
            ::usleep(2000);
        }
        return made(detail::allocateSamples(kInput, 48));
    });
    EXPECT_EQ(result.format, "DICOM");
    EXPECT_GE(handled, 1);
    sigaction(SIGTERM, &before, nullptr);
}

TEST(Sandbox, WorksWhereTheCallerIgnoresItsChildren) {
    const auto before = std::signal(SIGCHLD, SIG_IGN);
    EXPECT_EQ(
        readInSandbox(kInput, kRoomy, [] { return made(detail::allocateSamples(kInput, 48)); })
            .format,
        "DICOM");
    expectOneLine(refusal([]() -> ReadVolume { std::abort(); }), "ended early");
    std::signal(SIGCHLD, before);
}

TEST(Sandbox, EndsWithItsParent) {
    // a process in between starts a sandboxed read that does not end, tells its child's id and dies
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    const pid_t between = ::fork();
    if (between == 0) {
        std::thread([] {
            ::usleep(300'000);
            ::kill(::getpid(), SIGKILL);
        }).detach();
        auto* const id = static_cast<volatile pid_t*>(
            ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
        std::thread([id, &ends] {
            while (*id == 0) ::usleep(1000);
            const pid_t child = *id;
            (void)!::write(ends[1], &child, sizeof child);
        }).detach();
        try {
            readInSandbox(kInput, kRoomy, [id]() -> ReadVolume {
                *id = ::getpid();
                for (;;) ::pause();
            });
        } catch (const Error&) {
        }
        std::_Exit(0);
    }
    pid_t child = 0;
    ASSERT_EQ(::read(ends[0], &child, sizeof child), static_cast<ssize_t>(sizeof child));
    int status = 0;
    ASSERT_EQ(::waitpid(between, &status, 0), between);
    EXPECT_TRUE(WIFSIGNALED(status));
    bool isGone = false;
    for (int i = 0; i < 2000 && !isGone; ++i) {  // 20 s: init may be slow to reap it
        std::ifstream state("/proc/" + std::to_string(child) + "/stat");
        std::string id, name, letter;
        isGone = !(state >> id >> name >> letter) || letter == "Z";
        if (!isGone) ::usleep(10'000);
    }
    EXPECT_TRUE(isGone);
    ::close(ends[0]);
    ::close(ends[1]);
}

TEST(Sandbox, WorksWhileOtherThreadsAllocate) {
    // fork copies one thread alone; the heap's locks must not stay locked in the child
    std::atomic<bool> goesOn{true};
    std::vector<std::thread> threads;
    for (int n = 0; n < 3; ++n) {
        threads.emplace_back([&] {
            while (goesOn) std::make_unique<std::vector<int>>(1000).reset();
        });
    }
    for (int n = 0; n < 50; ++n) {
        EXPECT_EQ(readInSandbox(kInput, kRoomy,
                                [] {
                                    const std::vector<std::string> some(100, std::string(99, 'x'));
                                    return made(detail::allocateSamples(kInput, 48));
                                })
                      .format,
                  "DICOM");
    }
    goesOn = false;
    for (std::thread& thread : threads) thread.join();
    expectNoChildLeft();
}

TEST(SandboxLimits, GrowWithTheInput) {
    const TempFolder folder;
    writeFile(folder / "a", std::string(2'000'000, 'x'));
    writeFile(folder / "b", std::string(1'000'000, 'x'));
    EXPECT_EQ(detail::sandboxLimitsFor(folder / "a").time, 17s);
    EXPECT_EQ(detail::sandboxLimitsFor(folder.path()).time, 18s);
    EXPECT_EQ(detail::sandboxLimitsFor(folder / "a").memoryBytes,
              std::min<std::uint64_t>((std::uint64_t{1} << 30) + 128'000'000,
                                      detail::machineMemoryBytes()));
    EXPECT_EQ(detail::sandboxLimitsFor(folder / "missing").time, 15s);
}

TEST(ReadVolume, ReadsDicomAlikeWithTheSandboxAndWithoutIt) {
    const TempFolder folder;
    for (int k = 0; k < 4; ++k) {
        writeFile(folder / std::to_string(k), stackedSlice(k).bytes());
    }
    const ReadVolume sandboxed = readVolume(folder.path());
    ReadOptions withoutSandbox;
    withoutSandbox.sandbox = false;
    const ReadVolume open = readVolume(folder.path(), withoutSandbox);
    EXPECT_EQ(samplesIn<std::uint16_t>(sandboxed.volume), samplesIn<std::uint16_t>(open.volume));
    EXPECT_EQ(sandboxed.volume.view().geometry(), open.volume.view().geometry());
    EXPECT_EQ(sandboxed.format, open.format);
    EXPECT_EQ(sandboxed.warnings, open.warnings);
}

}  // namespace
}  // namespace adaptiso::testing
