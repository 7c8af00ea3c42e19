// What the fuzz targets share. A target takes any bytes: it may refuse them with an error of kind
// usage, input or output, and nothing else. Whatever ends the process is a finding.
//
// The targets run under libFuzzer (tests/fuzz/run), and over the kept corpus in the normal tests
// (replay_main.cpp).
#pragma once

#include "base/error.h"
#include "image/image.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace ql::fuzz {

// A folder of this process in $TMPDIR, removed at the end of a run without findings.
const std::string& scratch_folder();

// Bytes as a file of the scratch folder; its path. The next call overwrites it.
const std::string& scratch_file(std::span<const uint8_t> bytes);

// Says what is wrong on standard error and aborts.
[[noreturn]] void report_finding(const std::string& what);

// Runs work(); an error that the input deserves is fine, any other is a finding. So is a message
// of more than one line.
template<class Work>
void refuse_or(const Work& work) {
    try {
        work();
    } catch (const Error& error) {
        if (error.kind() == ErrorKind::internal) report_finding(error.what());
        if (std::string_view(error.what()).find('\n') != std::string_view::npos)
            report_finding(std::string("a message of several lines: ") + error.what());
    }
}

// What every rendered image keeps to: no NaN, no infinity, no negative radiance.
void check_picture(const Image& image, const char* renderer);

} // namespace ql::fuzz
