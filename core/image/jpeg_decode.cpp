#include "image/jpeg_decode.h"

#include "base/error.h"

#include <cstdio> // jpeglib.h does not include what it needs

#include <jpeglib.h>

#include <cmath>
#include <csetjmp>
#include <new>

namespace ql {

namespace {

// libjpeg leaves by on_error(), which must not return. Whatever calls it stands in functions of
// plain values, so that no destructor is jumped over; each says whether it came to its end.
struct Handler {
    jpeg_error_mgr manager;
    std::jmp_buf jump;
    char text[JMSG_LENGTH_MAX];
};

void on_error(j_common_ptr info) {
    auto* handler = reinterpret_cast<Handler*>(info->err); // its first member
    info->err->format_message(info, handler->text);
    std::longjmp(handler->jump, 1);
}

void on_message(j_common_ptr) {} // warnings: a decoder makes the best of the file

bool read_header(jpeg_decompress_struct& info, Handler& handler, std::span<const std::byte> bytes) {
    if (setjmp(handler.jump)) return false;
    jpeg_create_decompress(&info);
    jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    jpeg_read_header(&info, TRUE);
    if (info.jpeg_color_space == JCS_CMYK || info.jpeg_color_space == JCS_YCCK)
        info.out_color_space = JCS_CMYK;
    jpeg_calc_output_dimensions(&info);
    return true;
}

bool read_rows(jpeg_decompress_struct& info, Handler& handler, uint8_t* samples) {
    if (setjmp(handler.jump)) return false;
    jpeg_start_decompress(&info);
    const size_t row_bytes = size_t(info.output_width) * size_t(info.output_components);
    while (info.output_scanline < info.output_height) {
        JSAMPROW row = samples + info.output_scanline * row_bytes;
        jpeg_read_scanlines(&info, &row, 1);
    }
    return true;
}

class Decompressor {
  public:
    Decompressor() {
        m_info.err = jpeg_std_error(&m_handler.manager);
        m_handler.manager.error_exit = on_error;
        m_handler.manager.output_message = on_message;
    }
    ~Decompressor() { jpeg_destroy_decompress(&m_info); }
    Decompressor(const Decompressor&) = delete;
    Decompressor& operator=(const Decompressor&) = delete;

    jpeg_decompress_struct& info() { return m_info; }
    Handler& handler() { return m_handler; }

  private:
    jpeg_decompress_struct m_info = {};
    Handler m_handler = {};
};

// Adobe's CMYK is stored as 1 - ink: what paper reflects is the product.
std::vector<uint8_t> rgb_of_cmyk(const std::vector<uint8_t>& cmyk) {
    constexpr float kScale = 1.0f / 255.0f;
    std::vector<uint8_t> rgb(cmyk.size() / 4 * 3);
    for (size_t i = 0; i < cmyk.size() / 4; ++i)
        for (size_t c = 0; c < 3; ++c) {
            const float value =
                (float(cmyk[4 * i + c]) * kScale) * (float(cmyk[4 * i + 3]) * kScale);
            rgb[3 * i + c] = uint8_t(value * 255.0f + 0.5f);
        }
    return rgb;
}

} // namespace

JpegImage decode_jpeg(std::span<const std::byte> bytes, const std::string& name,
                      size_t max_pixels) {
    Decompressor decompressor;
    jpeg_decompress_struct& info = decompressor.info();
    Handler& handler = decompressor.handler();
    if (!read_header(info, handler, bytes)) throw input_error("{}: {}", name, handler.text);
    const size_t pixels = size_t(info.output_width) * size_t(info.output_height);
    if (pixels > max_pixels)
        throw input_error("{}: {} x {} pixels, more than the limit of {}", name, info.output_width,
                          info.output_height, max_pixels);
    const int channels = info.output_components;
    if (channels != 1 && channels != 3 && channels != 4)
        throw input_error("{}: {} channels, expected 1, 3 or 4", name, channels);
    std::vector<uint8_t> samples(pixels * size_t(channels));
    if (!read_rows(info, handler, samples.data())) throw input_error("{}: {}", name, handler.text);
    JpegImage image = {int(info.output_width), int(info.output_height), channels, {}};
    if (channels == 4) {
        image.channels = 3;
        image.samples = rgb_of_cmyk(samples);
    } else {
        image.samples = std::move(samples);
    }
    return image;
}

} // namespace ql
