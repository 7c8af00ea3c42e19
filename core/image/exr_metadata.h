// The attributes of an OpenEXR header as the metadata of an image, and back.
//
// Integers, floats, strings, 4 x 4 matrices and runs of floats travel under their names; what
// belongs to the file and not to the image (channels, windows, compression, date) does not. A few
// names differ, as in other image formats: "ImageDescription" is "comments" in the file.
#pragma once

#include "image/image.h"

#include <OpenEXR/ImfForward.h>

namespace ql {

Metadata exr_metadata(const Imf::Header& header);

// Strings and lists without content are left out, and what the header has already.
void insert_exr_metadata(const Metadata& metadata, Imf::Header& header);

} // namespace ql
