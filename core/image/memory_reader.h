// Encoded bytes in memory for OpenImageIO to read. Include in image/*.cpp alone.
//
// The library's own IOMemReader (2.4) reads beyond its end where a damaged file sends it to an
// offset behind the last byte; some of its readers insist on that class, so this one derives from
// it.
#pragma once

#include <OpenImageIO/filesystem.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>

namespace ql {

class MemoryReader final : public OIIO::Filesystem::IOMemReader {
  public:
    explicit MemoryReader(std::span<const std::byte> bytes)
        : IOMemReader(const_cast<std::byte*>(bytes.data()), bytes.size()), m_bytes(bytes) {}

    size_t read(void* to, size_t size) override {
        size = pread(to, size, m_pos);
        m_pos += int64_t(size);
        return size;
    }

    size_t pread(void* to, size_t size, int64_t offset) override {
        if (offset < 0 || size_t(offset) >= m_bytes.size()) return 0;
        size = std::min(size, m_bytes.size() - size_t(offset));
        std::memcpy(to, &m_bytes[size_t(offset)], size);
        return size;
    }

  private:
    std::span<const std::byte> m_bytes;
};

} // namespace ql
