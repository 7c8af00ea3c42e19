#include "image/atomic_file.h"

#include "base/error.h"

#include <fcntl.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>
#include <filesystem>

namespace ql {

namespace {

// Names of the temporary files that exist right now, in memory that a signal handler may read.
constexpr int kMaxTemporaries = 64;
struct TemporaryName {
    std::atomic<bool> used = false;
    std::atomic<bool> exists = false;
    char path[PATH_MAX] = {};
};
TemporaryName g_temporaries[kMaxTemporaries];
std::atomic<int> g_creating = 0;   // threads between "may I create" and "it is listed"
std::atomic<bool> g_dying = false; // set by remove_temporary_files

// Keeps signal handlers off this thread, so that a handler may wait for g_creating to reach zero.
class SignalsBlocked {
  public:
    SignalsBlocked() {
        sigset_t all;
        sigfillset(&all);
        pthread_sigmask(SIG_BLOCK, &all, &m_before);
    }
    ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &m_before, nullptr); }
    SignalsBlocked(const SignalsBlocked&) = delete;
    SignalsBlocked& operator=(const SignalsBlocked&) = delete;

  private:
    sigset_t m_before = {};
};

// Once the process is about to die, no thread may report that its file is gone.
void wait_if_dying() {
    while (g_dying)
        pause();
}

TemporaryName& free_slot() {
    for (;;)
        for (TemporaryName& slot : g_temporaries) {
            bool expected = false;
            if (slot.used.compare_exchange_strong(expected, true)) return slot;
        }
}

// A temporary file beside the target, removed unless it was renamed to it.
class TemporaryFile {
  public:
    explicit TemporaryFile(const std::string& target) : m_target(target), m_slot(free_slot()) {
        if (target.size() + 32 > PATH_MAX) {
            m_slot.used = false;
            throw output_error("{}: the path is too long", target.substr(0, 80));
        }
        const size_t slash = target.rfind('/');
        const size_t name_at = slash == std::string::npos ? 0 : slash + 1;
        const std::string prefix = target.substr(0, name_at) + "." + target.substr(name_at) + ".";
        const SignalsBlocked blocked;
        ++g_creating;
        if (!g_dying) create(prefix);
        const int reason = errno;
        m_slot.exists = m_descriptor >= 0;
        --g_creating;
        wait_if_dying();
        if (m_descriptor < 0) {
            m_slot.used = false;
            throw output_error("{}: cannot be created ({})", target, std::strerror(reason));
        }
    }
    ~TemporaryFile() {
        if (m_descriptor >= 0) close(m_descriptor);
        if (m_slot.exists) unlink(m_slot.path);
        m_slot.exists = false;
        m_slot.used = false;
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    int descriptor() const { return m_descriptor; }

    void rename_to_target() {
        // A file that is there keeps its permissions.
        struct stat old = {};
        if (stat(m_target.c_str(), &old) == 0) fchmod(m_descriptor, old.st_mode & 07777);
        const int closed = close(m_descriptor);
        m_descriptor = -1;
        if (closed != 0 || std::rename(m_slot.path, m_target.c_str()) != 0) {
            const int reason = errno;
            wait_if_dying();
            throw output_error("{}: cannot be written ({})", m_target, std::strerror(reason));
        }
        m_slot.exists = false;
    }

  private:
    // Under the first name that is free; the permissions are those of any new file.
    void create(const std::string& prefix) {
        static std::atomic<unsigned> g_count = 0;
        constexpr int kMostAttempts = 1000;
        for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
            const std::string path = fmt::format("{}{:x}-{:x}", prefix, getpid(), g_count++);
            std::memcpy(m_slot.path, path.c_str(), path.size() + 1);
            m_descriptor = open(m_slot.path, O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
            if (m_descriptor >= 0 || errno != EEXIST) return;
        }
    }

    std::string m_target;
    TemporaryName& m_slot;
    int m_descriptor = -1;
};

void write_all(int descriptor, std::span<const std::byte> bytes, const std::string& name) {
    while (!bytes.empty()) {
        const ssize_t n = write(descriptor, bytes.data(), std::min<size_t>(bytes.size(), 1 << 30));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) throw output_error("{}: cannot be written ({})", name, std::strerror(errno));
        bytes = bytes.subspan(size_t(n));
    }
}

Error too_large(const std::string& name, size_t max_bytes) {
    return input_error("{}: larger than {} bytes, the most that is read", name, max_bytes);
}

// The file that a link leads to, be it there or not.
std::string followed(const std::string& path) {
    namespace fs = std::filesystem;
    constexpr int kMostLinks = 40;
    fs::path at = path;
    for (int links = 0; links < kMostLinks; ++links) {
        std::error_code error;
        const fs::path next = fs::read_symlink(at, error);
        if (error) return at.string(); // no link
        // What these lead to is open already, and has no name to be renamed to.
        if (at.string().starts_with("/proc/") || at.string().starts_with("/dev/"))
            return at.string();
        at = next.is_absolute() ? next : at.parent_path() / next;
    }
    throw output_error("{}: a circle of links", path);
}

// A device or pipe takes the bytes as they come; renaming over it would replace it by a file.
bool is_special_file(const std::string& path) {
    struct stat status = {};
    if (stat(path.c_str(), &status) != 0 || S_ISDIR(status.st_mode)) return false;
    return !S_ISREG(status.st_mode) || path.starts_with("/proc/") || path.starts_with("/dev/fd/") ||
           path.starts_with("/dev/std");
}

} // namespace

std::vector<std::byte> read_file(const std::string& path, size_t max_bytes) {
    const bool standard_input = path == "-";
    const std::string name = input_name(path);
    const int descriptor = standard_input ? 0 : open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) throw input_error("{}: {}", name, std::strerror(errno));
    struct Closer {
        int d;
        ~Closer() {
            if (d > 0) close(d);
        }
    } closer{descriptor};
    constexpr size_t kStep = size_t(1) << 20;
    size_t room = kStep;
    struct stat status = {};
    if (fstat(descriptor, &status) == 0) {
        if (S_ISDIR(status.st_mode)) throw input_error("{}: is a folder, expected a file", name);
        if (S_ISREG(status.st_mode) && status.st_size > 0) {
            if (size_t(status.st_size) > max_bytes) throw too_large(name, max_bytes);
            room = size_t(status.st_size) + 1; // where its end shows
        }
    }
    std::vector<std::byte> bytes;
    for (size_t size = 0;;) {
        // A file is given its size; what has none, or grows, twice what it has.
        if (size == bytes.size()) {
            bytes.resize(size + std::max(size, room));
            room = kStep;
        }
        const ssize_t n = read(descriptor, bytes.data() + size, bytes.size() - size);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) throw input_error("{}: {}", name, std::strerror(errno));
        size += size_t(n);
        if (size > max_bytes) throw too_large(name, max_bytes);
        if (n == 0) {
            bytes.resize(size);
            return bytes;
        }
    }
}

void write_file(const std::string& path, std::span<const std::byte> bytes) {
    if (path == "-") {
        if (isatty(1)) throw output_error("standard output is a terminal, expected a file or pipe");
        write_all(1, bytes, "standard output");
        return;
    }
    const std::string target = followed(path);
    if (is_special_file(target)) {
        // A file that standard output goes to is not begun anew
        const int descriptor = open(target.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
        if (descriptor < 0) throw output_error("{}: {}", path, std::strerror(errno));
        try {
            write_all(descriptor, bytes, path);
        } catch (...) {
            close(descriptor);
            throw;
        }
        if (close(descriptor) != 0) throw output_error("{}: {}", path, std::strerror(errno));
        return;
    }
    TemporaryFile file(target);
    write_all(file.descriptor(), bytes, path);
    file.rename_to_target();
}

void write_file(const std::string& path, const std::string& text) {
    write_file(path, std::as_bytes(std::span(text.data(), text.size())));
}

void remove_temporary_files() noexcept {
    g_dying = true;
    while (g_creating > 0) {
    }
    for (TemporaryName& slot : g_temporaries)
        if (slot.exists) unlink(slot.path);
}

} // namespace ql
