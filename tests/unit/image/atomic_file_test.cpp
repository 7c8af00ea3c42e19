#include "image/atomic_file.h"

#include "base/error.h"
#include "cli/signals.h"
#include "unit/scratch_folder.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <thread>

namespace ql {
namespace {

std::string text_of(const std::string& path) {
    const std::vector<std::byte> bytes = read_file(path);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

ErrorKind kind_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        return error.kind();
    }
    ADD_FAILURE() << "no error";
    return ErrorKind::internal;
}

TEST(AtomicFile, ReadsBackWhatWasWritten) {
    const ScratchFolder folder;
    for (const size_t size : {size_t(0), size_t(1), size_t(1) << 20, (size_t(1) << 20) + 1}) {
        const std::string text(size, 'x');
        write_file(folder / "a", text);
        EXPECT_EQ(text_of(folder / "a"), text);
    }
    EXPECT_EQ(folder.file_count(), 1u);
}

TEST(AtomicFile, ReadingTakesNoMoreMemoryThanTheFile) {
    const ScratchFolder folder;
    for (const size_t size : {size_t(3), (size_t(1) << 20) + 1}) {
        write_file(folder / "a", std::string(size, 'x'));
        EXPECT_LE(read_file(folder / "a").capacity(), size + 1);
    }
}

TEST(AtomicFile, HasThePermissionsOfAnOrdinaryNewFile) {
    const ScratchFolder folder;
    const mode_t before = umask(027);
    write_file(folder / "a", "x");
    umask(before);
    struct stat status = {};
    ASSERT_EQ(stat((folder / "a").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, mode_t(0640));
}

TEST(AtomicFile, LeavesTheOldFileWhenWritingFails) {
    const ScratchFolder folder;
    std::filesystem::create_directory(folder / "target");
    EXPECT_EQ(kind_of([&] { write_file(folder / "target", "x"); }), ErrorKind::output);
    EXPECT_EQ(kind_of([&] { write_file(folder / "no/such/folder", "x"); }), ErrorKind::output);
    EXPECT_EQ(kind_of([&] { write_file(folder / std::string(5000, 'n'), "x"); }),
              ErrorKind::output);
    EXPECT_EQ(kind_of([&] { write_file(folder / std::string(255, 'n'), "x"); }), ErrorKind::output);
    EXPECT_EQ(kind_of([&] { write_file("/dev/full", "x"); }), ErrorKind::output);
    EXPECT_EQ(folder.file_count(), 1u);
}

TEST(AtomicFile, WritesIntoDevicesAndDoesNotReplaceThem) {
    write_file("/dev/null", "x");
    struct stat status = {};
    ASSERT_EQ(stat("/dev/null", &status), 0);
    EXPECT_TRUE(S_ISCHR(status.st_mode));
}

TEST(AtomicFile, ReadingSaysWhatIsWrong) {
    const ScratchFolder folder;
    EXPECT_EQ(kind_of([&] { read_file(folder / "missing"); }), ErrorKind::input);
    EXPECT_EQ(kind_of([&] { read_file(folder / ""); }), ErrorKind::input);
    write_file(folder / "ten", "0123456789");
    EXPECT_EQ(read_file(folder / "ten", 10).size(), 10u);
    EXPECT_EQ(kind_of([&] { read_file(folder / "ten", 9); }), ErrorKind::input);
    EXPECT_EQ(kind_of([&] { read_file("/dev/zero", 1 << 22); }), ErrorKind::input);
}

TEST(AtomicFile, RefusesALargeFileBeforeItTakesMemory) {
    const ScratchFolder folder;
    write_file(folder / "sparse", "");
    ASSERT_EQ(truncate((folder / "sparse").c_str(), off_t(1) << 42), 0);
    EXPECT_EQ(kind_of([&] { read_file(folder / "sparse"); }), ErrorKind::input);
}

TEST(AtomicFile, ThreadsWriteTheSameFileWithoutMixing) {
    const ScratchFolder folder;
    std::vector<std::thread> threads;
    for (char c = 'a'; c < 'i'; ++c)
        threads.emplace_back([&folder, c] {
            for (int i = 0; i < 20; ++i)
                write_file(folder / "shared", std::string(100'000, c));
        });
    for (std::thread& thread : threads)
        thread.join();
    const std::string text = text_of(folder / "shared");
    EXPECT_EQ(text, std::string(100'000, text.front()));
    EXPECT_EQ(folder.file_count(), 1u);
}

// A process that writes files without end, from several threads, is stopped.
void write_for_ever(const ScratchFolder& folder) {
    cli::install_signal_handlers();
    const std::string text(4 << 20, 'x');
    std::vector<std::thread> threads;
    for (int i = 0; i < 3; ++i)
        threads.emplace_back([&folder, &text, i] {
            for (;;)
                write_file(folder / ("out" + std::to_string(i)), text);
        });
    for (std::thread& thread : threads)
        thread.join();
}

TEST(AtomicFile, ASignalLeavesOnlyWholeFilesAndIsTheCauseOfDeath) {
    for (int round = 0; round < 24; ++round) {
        const ScratchFolder folder;
        const int signal_number = round % 2 ? SIGTERM : SIGINT;
        const pid_t child = fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            std::signal(SIGINT, SIG_DFL);
            write_for_ever(folder);
            _exit(0);
        }
        int status = 0;
        while (folder.file_count() == 0) {
            ASSERT_EQ(waitpid(child, &status, WNOHANG), 0) << "the child has ended";
            usleep(100);
        }
        usleep(useconds_t(700 * round));
        kill(child, signal_number);
        ASSERT_EQ(waitpid(child, &status, 0), child);
        EXPECT_TRUE(WIFSIGNALED(status));
        EXPECT_EQ(WTERMSIG(status), signal_number);
        for (const auto& entry :
             std::filesystem::directory_iterator(std::filesystem::path(folder / ""))) {
            EXPECT_EQ(entry.path().filename().string().substr(0, 3), "out");
            EXPECT_EQ(entry.file_size(), uintmax_t(4 << 20));
        }
    }
}

TEST(AtomicFile, WritesWhereALinkLeadsAndLeavesTheLink) {
    const ScratchFolder folder, other;
    for (const std::string& target : {other / "there", other / "new"}) {
        if (target.ends_with("there")) write_file(target, "old");
        ASSERT_EQ(symlink(target.c_str(), (folder / "link").c_str()), 0);
        write_file(folder / "link", "text");
        struct stat status = {};
        ASSERT_EQ(lstat((folder / "link").c_str(), &status), 0);
        EXPECT_TRUE(S_ISLNK(status.st_mode));
        EXPECT_EQ(text_of(target), "text");
        unlink((folder / "link").c_str());
    }
    EXPECT_EQ(other.file_count(), 2u);
    ASSERT_EQ(symlink("circle", (folder / "circle").c_str()), 0);
    EXPECT_EQ(kind_of([&] { write_file(folder / "circle", "x"); }), ErrorKind::output);
}

TEST(AtomicFile, KeepsThePermissionsOfTheFileThatItReplaces) {
    const ScratchFolder folder;
    write_file(folder / "a", "x");
    ASSERT_EQ(chmod((folder / "a").c_str(), 0600), 0);
    write_file(folder / "a", "y");
    struct stat status = {};
    ASSERT_EQ(stat((folder / "a").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0600u);
}

TEST(AtomicFile, WritesToWhatADescriptorHasOpen) {
    const ScratchFolder folder;
    write_file(folder / "a", "before ");
    const int descriptor = open((folder / "a").c_str(), O_WRONLY | O_APPEND);
    ASSERT_GE(descriptor, 0);
    write_file("/proc/self/fd/" + std::to_string(descriptor), "after");
    close(descriptor);
    EXPECT_EQ(text_of(folder / "a"), "before after");
}

} // namespace
} // namespace ql
