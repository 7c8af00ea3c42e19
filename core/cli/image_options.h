// Options of the tools that measure images: which part, which channels, which rectangle.
#pragma once

#include "cli/tool.h"

#include <optional>

namespace ql::cli {

struct Rectangle {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;
};

struct ImageSelection {
    // Empty: R, G, B of an image that has one of them, all float channels of another.
    std::vector<std::string> channels;
    std::string layer; // channels are those named "layer.*"
    std::string part;  // name, or number from 0; empty: the only part there is
    std::optional<Rectangle> crop;
};

// --channels, --layer, --part, --crop
void add_image_selection(Tool& tool, ImageSelection& selection);

// The float planes that are selected, cropped; read whole and then cut. Errors: ErrorKind::input
// if the file has no such part or channel, or the rectangle is not inside.
Image read_selected(Session& session, const std::string& path, const ImageSelection& selection,
                    NonFinite non_finite);

// "x,y,w,h" of whole numbers, x and y from 0, w and h from 1. Errors: ErrorKind::usage.
Rectangle parse_rectangle(const std::string& text);

} // namespace ql::cli
