// Whole-file reading and writing. A file appears under its final name whole or not at all.
//
// The bytes are first written to a temporary file beside the target (where a link leads to: beside
// that) and then renamed. If the process is about to die by a signal, remove_temporary_files()
// takes away what is half written; it is async-signal-safe. Threads may write different files at
// the same time.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace ql {

// What messages call a path: "-" is a standard stream.
inline std::string input_name(const std::string& path) {
    return path == "-" ? "standard input" : path;
}
inline std::string output_name(const std::string& path) {
    return path == "-" ? "standard output" : path;
}

// path "-" is standard input. Errors: ErrorKind::input. max_bytes bounds what is taken in.
std::vector<std::byte> read_file(const std::string& path, size_t max_bytes = size_t(1) << 36);

// path "-" is standard output, which must not be a terminal. Errors: ErrorKind::output.
void write_file(const std::string& path, std::span<const std::byte> bytes);
void write_file(const std::string& path, const std::string& text);

// For signal handlers. After this call no thread creates another temporary file.
void remove_temporary_files() noexcept;

} // namespace ql
