#include "bluenoise/retarget_file.h"

#include <charconv>
#include <cmath>

namespace ql {

namespace {

constexpr int kPngZero = 128;

std::string pair_text(const Imath::V2i& v) {
    return fmt::format("{},{}", v.x, v.y);
}

std::string header_text(const Image& image, const std::string& key, const std::string& path) {
    if (const auto* text = image.find_metadata<std::string>(key)) return *text;
    throw input_error("{}: no {} in the header, expected a retarget texture of bn-anneal", path,
                      key);
}

template<class Number>
const char* parse_number(const char* at, const char* end, Number& number) {
    const auto [next, error] = std::from_chars(at, end, number);
    return error == std::errc() ? next : nullptr;
}

Imath::V2i header_pair(const Image& image, const std::string& key, const std::string& path) {
    const std::string text = header_text(image, key, path);
    const char* const end = text.data() + text.size();
    Imath::V2i pair(0, 0);
    const char* at = parse_number(text.data(), end, pair.x);
    if (at && at != end && *at == ',') at = parse_number(at + 1, end, pair.y);
    if (at != end)
        throw input_error("{}: {} is '{}', expected dx,dy", path, key, text.substr(0, 40));
    return pair;
}

template<class Number>
Number header_number(const Image& image, const std::string& key, const std::string& path) {
    const std::string text = header_text(image, key, path);
    Number number = 0;
    if (parse_number(text.data(), text.data() + text.size(), number) != text.data() + text.size())
        throw input_error("{}: {} is '{}', expected a number", path, key, text.substr(0, 40));
    return number;
}

int move_component(float value, int zero, const std::string& path) {
    const float move = std::round(value) - float(zero);
    if (!(std::abs(move) <= kMaxRetargetMove) || std::round(value) != value)
        throw input_error("{}: a move of {} pixels, expected whole ones up to {}", path,
                          value - float(zero), kMaxRetargetMove);
    return int(move);
}

Array2D<Imath::V2i> read_moves(const Image& image, const std::string& path) {
    const auto *dx = image.find("dx"), *dy = image.find("dy");
    const bool png = !dx && !dy && image.source_bits == 8;
    if (png) {
        dx = image.find("R");
        dy = image.find("G");
    }
    if (!dx || !dy)
        throw input_error("{}: channels {}, expected dx, dy (or R, G of 8 bits)", path,
                          image.channel_names());
    Array2D<Imath::V2i> moves(image.width, image.height, {0, 0});
    for (size_t i = 0; i < moves.size(); ++i) {
        const auto component = [&](float value) {
            return png ? move_component(std::round(value * 255), kPngZero, path)
                       : move_component(value, 0, path);
        };
        moves[i] = {component((*dx)[i]), component((*dy)[i])};
    }
    return moves;
}

void check_bijection(const Array2D<Imath::V2i>& moves, const std::string& path) {
    Array2D<uint8_t> reached(moves.width(), moves.height());
    for (int y = 0; y < moves.height(); ++y)
        for (int x = 0; x < moves.width(); ++x) {
            const Imath::V2i move = moves(x, y);
            uint8_t& count =
                reached(wrap(x + move.x, moves.width()), wrap(y + move.y, moves.height()));
            if (count++ > 0)
                throw input_error("{}: two pixels move to the same place (one of them {},{}), "
                                  "expected a bijection",
                                  path, x, y);
        }
}

} // namespace

Image retarget_image(const RetargetTexture& texture, RetargetEncoding encoding) {
    const bool png = encoding == RetargetEncoding::png;
    const auto& moves = texture.moves;
    Image image(moves.width(), moves.height());
    image.plane(png ? "R" : "dx");
    image.plane(png ? "G" : "dy");
    if (png) image.plane("B");
    for (size_t i = 0; i < moves.size(); ++i)
        for (int axis = 0; axis < 2; ++axis)
            image.planes[size_t(axis)].pixels[i] =
                png ? float(moves[i][axis] + kPngZero) / 255 : float(moves[i][axis]);
    image.metadata["ql:mask"] = texture.mask_hash;
    image.metadata["ql:step"] = pair_text(texture.step);
    image.metadata["ql:motion"] = pair_text(texture.motion);
    image.metadata["ql:radius_px"] = fmt::to_string(texture.radius_px);
    image.metadata["ql:energy_initial"] = fmt::to_string(texture.report.energy_initial);
    image.metadata["ql:energy"] = fmt::to_string(texture.report.energy);
    image.metadata["ql:energy_bound"] = fmt::to_string(texture.energy_bound);
    return image;
}

std::vector<RetargetTexture> retarget_textures(const std::vector<Image>& parts,
                                               const std::string& path) {
    std::vector<RetargetTexture> textures;
    for (const Image& part : parts) {
        RetargetTexture texture;
        texture.moves = read_moves(part, path);
        check_bijection(texture.moves, path);
        texture.mask_hash = header_text(part, "ql:mask", path);
        texture.step = header_pair(part, "ql:step", path);
        texture.step = {wrap(texture.step.x, part.width), wrap(texture.step.y, part.height)};
        texture.motion = header_pair(part, "ql:motion", path);
        for (const int64_t move : {texture.motion.x, texture.motion.y})
            if (std::abs(move) > kMaxRetargetMove)
                throw input_error("{}: a motion of {} px, expected at most {}", path, move,
                                  kMaxRetargetMove);
        texture.radius_px = header_number<int>(part, "ql:radius_px", path);
        texture.report.energy_initial = header_number<int64_t>(part, "ql:energy_initial", path);
        texture.report.energy = header_number<int64_t>(part, "ql:energy", path);
        texture.report.bijection = true;
        texture.energy_bound = header_number<double>(part, "ql:energy_bound", path);
        textures.push_back(std::move(texture));
    }
    return textures;
}

std::string retarget_name(const RetargetTexture& texture, NamedBy named_by) {
    const std::string motion = fmt::format("motion_{}_{}", texture.motion.x, texture.motion.y);
    return named_by == NamedBy::motion
               ? motion
               : fmt::format("step_{}_{}_{}", texture.step.x, texture.step.y, motion);
}

} // namespace ql
