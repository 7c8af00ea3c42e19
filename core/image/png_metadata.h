// The texts in a PNG file as the metadata of an image, and back.
//
// PNG holds strings only; other values are left out. Keywords are our names, but for a few that the
// PNG specification has its own for ("Description"), and the name of the image.
#pragma once

#include "image/image.h"
#include "image/png_codec.h"

namespace ql {

void read_png_text(const PngText& text, Image& image);

// `software` stands first and in place of the image's own.
PngText png_text(const Image& image, const std::string& software);

} // namespace ql
