// OpenEXR files in memory, for the library to read and write. Include in image/*.cpp alone.
#pragma once

#include <OpenEXR/ImfIO.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace ql {

class ExrMemoryOutput final : public Imf::OStream {
  public:
    ExrMemoryOutput() : OStream("memory") {}
    void write(const char* data, int size) override {
        const size_t end = m_position + size_t(size);
        if (m_bytes.size() < end) m_bytes.resize(end);
        std::memcpy(m_bytes.data() + m_position, data, size_t(size));
        m_position = end;
    }
    uint64_t tellp() override { return m_position; }
    void seekp(uint64_t position) override { m_position = position; }
    std::span<const std::byte> bytes() const { return m_bytes; }
    std::vector<std::byte> take_bytes() { return std::move(m_bytes); }

  private:
    std::vector<std::byte> m_bytes;
    size_t m_position = 0;
};

// A damaged file may send the library to any place, behind the last byte too.
class ExrMemoryInput final : public Imf::IStream {
  public:
    explicit ExrMemoryInput(std::span<const std::byte> bytes) : IStream("memory"), m_bytes(bytes) {}
    bool read(char* data, int size) override {
        if (size < 0 || m_position > m_bytes.size() || m_bytes.size() - m_position < size_t(size))
            throw std::runtime_error("the file ends early");
        std::memcpy(data, m_bytes.data() + m_position, size_t(size));
        m_position += size_t(size);
        return m_position < m_bytes.size();
    }
    uint64_t tellg() override { return m_position; }
    void seekg(uint64_t position) override { m_position = position; }

  private:
    std::span<const std::byte> m_bytes;
    size_t m_position = 0;
};

} // namespace ql
