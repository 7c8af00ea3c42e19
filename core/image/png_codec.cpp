#include "image/png_codec.h"

#include "base/check.h"
#include "base/error.h"

#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstring>
#include <new>
#include <stdexcept>

namespace ql {

namespace {

// libpng leaves by longjmp() when something is wrong. Whatever calls it stands in functions of
// plain values, so that no destructor is jumped over; each says whether it came to its end.
struct Failure {
    char text[256] = "cannot be decoded";
};

void on_error(png_structp png, png_const_charp text) {
    auto* failure = static_cast<Failure*>(png_get_error_ptr(png));
    std::strncpy(failure->text, text, sizeof failure->text - 1);
    png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {} // of profiles and the like

struct Source {
    std::span<const std::byte> bytes;
    size_t at = 0;
};

void read_bytes(png_structp png, png_bytep to, size_t size) {
    auto* source = static_cast<Source*>(png_get_io_ptr(png));
    if (size > source->bytes.size() - source->at) png_error(png, "the file ends early");
    std::memcpy(to, source->bytes.data() + source->at, size);
    source->at += size;
}

void write_bytes(png_structp png, png_bytep from, size_t size) {
    auto* bytes = static_cast<std::vector<std::byte>*>(png_get_io_ptr(png));
    bool enough = true;
    try {
        const auto* begin = reinterpret_cast<const std::byte*>(from);
        bytes->insert(bytes->end(), begin, begin + size);
    } catch (const std::exception&) { // must not pass through libpng
        enough = false;
    }
    if (!enough) png_error(png, "not enough memory");
}

void flush_bytes(png_structp) {}

bool read_info(png_structp png, png_infop info) {
    if (setjmp(png_jmpbuf(png))) return false;
    png_read_info(png, info);
    png_set_expand(png);
    if (std::endian::native == std::endian::little) png_set_swap(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    return true;
}

bool read_image(png_structp png, png_bytepp rows) {
    if (setjmp(png_jmpbuf(png))) return false;
    png_read_image(png, rows);
    return true;
}

struct WriteRequest {
    png_uint_32 width, height;
    int bits, colour_type;
    bool srgb;
    png_time date;
    std::span<png_text> text;
    png_bytepp rows;
};

bool write_image(png_structp png, png_infop info, const WriteRequest& request) {
    if (setjmp(png_jmpbuf(png))) return false;
    // The level is a balance of time and size; filters gain nothing with noise and data.
    png_set_compression_level(png, 6);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_NO_FILTERS);
    png_set_IHDR(png, info, request.width, request.height, request.bits, request.colour_type,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (request.srgb)
        png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_ABSOLUTE);
    else
        png_set_gAMA(png, info, 1.0);
    png_set_tIME(png, info, &request.date);
    if (!request.text.empty())
        png_set_text(png, info, request.text.data(), int(request.text.size()));
    png_write_info(png, info);
    if (std::endian::native == std::endian::little) png_set_swap(png);
    png_write_image(png, request.rows);
    png_write_end(png, info);
    return true;
}

class Writer {
  public:
    explicit Writer(Failure& failure)
        : m_png(png_create_write_struct(PNG_LIBPNG_VER_STRING, &failure, on_error, on_warning)),
          m_info(m_png ? png_create_info_struct(m_png) : nullptr) {
        if (!m_info) throw std::bad_alloc();
    }
    ~Writer() { png_destroy_write_struct(&m_png, &m_info); }
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;

    png_structp png() const { return m_png; }
    png_infop info() const { return m_info; }

  private:
    png_structp m_png;
    png_infop m_info;
};

// Pointers to rows of `row_bytes` each.
std::vector<png_bytep> row_pointers(void* samples, size_t rows, size_t row_bytes) {
    std::vector<png_bytep> pointers(rows);
    for (size_t y = 0; y < rows; ++y)
        pointers[y] = static_cast<png_bytep>(samples) + y * row_bytes;
    return pointers;
}

int colour_type(int channels) {
    constexpr int kTypes[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                              PNG_COLOR_TYPE_RGB_ALPHA};
    return kTypes[channels - 1];
}

} // namespace

struct PngReader::State {
    explicit State(std::span<const std::byte> bytes)
        : source{bytes},
          png(png_create_read_struct(PNG_LIBPNG_VER_STRING, &failure, on_error, on_warning)),
          info(png ? png_create_info_struct(png) : nullptr) {
        if (!info) throw std::bad_alloc();
        png_set_read_fn(png, &source, read_bytes);
    }
    ~State() { png_destroy_read_struct(&png, &info, nullptr); }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    Failure failure;
    Source source;
    png_structp png;
    png_infop info;
};

PngReader::PngReader(std::span<const std::byte> bytes, const std::string& name)
    : m_name(name), m_state(std::make_unique<State>(bytes)) {
    png_structp png = m_state->png;
    png_infop info = m_state->info;
    if (!read_info(png, info)) throw input_error("{}: {}", m_name, m_state->failure.text);
    m_header.width = int(png_get_image_width(png, info));
    m_header.height = int(png_get_image_height(png, info));
    m_header.channels = png_get_channels(png, info);
    m_header.bits = png_get_bit_depth(png, info);
    png_textp text = nullptr;
    const int count = png_get_text(png, info, &text, nullptr);
    for (int i = 0; i < count; ++i)
        m_header.text.emplace_back(text[i].key, text[i].text ? text[i].text : "");
}

PngReader::~PngReader() = default;

void PngReader::read_rows(void* samples) {
    const auto rows = size_t(m_header.height);
    const size_t row_bytes = m_header.sample_count() / rows * size_t(m_header.bits / 8);
    QL_CHECK_EQ(png_get_rowbytes(m_state->png, m_state->info), row_bytes);
    std::vector<png_bytep> pointers = row_pointers(samples, rows, row_bytes);
    if (!read_image(m_state->png, pointers.data()))
        throw input_error("{}: {}", m_name, m_state->failure.text);
}

std::vector<uint8_t> PngReader::samples8() {
    QL_CHECK_EQ(m_header.bits, 8);
    std::vector<uint8_t> samples(m_header.sample_count());
    read_rows(samples.data());
    return samples;
}

std::vector<uint16_t> PngReader::samples16() {
    QL_CHECK_EQ(m_header.bits, 16);
    std::vector<uint16_t> samples(m_header.sample_count());
    read_rows(samples.data());
    return samples;
}

std::vector<std::byte> png_bytes(const PngHeader& header, std::span<const uint16_t> samples,
                                 PngTransfer transfer, const PngDate& date) {
    QL_CHECK_EQ(samples.size(), header.sample_count());
    QL_CHECK(header.channels >= 1 && header.channels <= 4);
    // libpng wants samples of the file's size, in memory that may be written to.
    std::vector<uint8_t> narrow;
    std::vector<uint16_t> wide;
    if (header.bits == 8)
        narrow.assign(samples.begin(), samples.end());
    else
        wide.assign(samples.begin(), samples.end());
    void* first = header.bits == 8 ? static_cast<void*>(narrow.data()) : wide.data();
    const auto rows = size_t(header.height);
    const size_t row_bytes = header.sample_count() / rows * size_t(header.bits / 8);
    std::vector<png_bytep> pointers = row_pointers(first, rows, row_bytes);

    PngText strings = header.text;
    std::vector<png_text> text;
    for (auto& [key, value] : strings) {
        if (key.empty()) continue;
        png_text entry = {};
        entry.compression = PNG_TEXT_COMPRESSION_NONE;
        entry.key = key.data();
        entry.text = value.data();
        text.push_back(entry);
    }

    std::vector<std::byte> bytes;
    Failure failure;
    const Writer writer(failure);
    png_set_write_fn(writer.png(), &bytes, write_bytes, flush_bytes);
    const png_time time = {png_uint_16(date.year), png_byte(date.month),  png_byte(date.day),
                           png_byte(date.hour),    png_byte(date.minute), png_byte(date.second)};
    const WriteRequest request = {png_uint_32(header.width),
                                  png_uint_32(header.height),
                                  header.bits,
                                  colour_type(header.channels),
                                  transfer == PngTransfer::srgb,
                                  time,
                                  text,
                                  pointers.data()};
    if (!write_image(writer.png(), writer.info(), request)) throw std::runtime_error(failure.text);
    return bytes;
}

} // namespace ql
