// Mutates the JSON of a glTF by its structure: numbers become others, members go or appear twice,
// values change places, encoded buffers change by a character. GLB chunks keep their lengths right.
// Every fourth time, or where nothing parses, bytes change as libFuzzer does it.
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);
extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size,
                                          unsigned int seed);

namespace {

using Json = nlohmann::ordered_json;
using Random = std::minstd_rand;

constexpr size_t kGlbHeaderBytes = 20;

size_t below(Random& random, size_t end) {
    return std::uniform_int_distribution<size_t>(0, end - 1)(random);
}

void collect(Json& json, std::vector<Json*>& values) {
    values.push_back(&json);
    if (json.is_structured())
        for (Json& child : json)
            collect(child, values);
}

Json number_like(const Json& old, Random& random) {
    static const std::vector<Json> kEnds = {0,
                                            1,
                                            -1,
                                            2,
                                            3,
                                            255,
                                            256,
                                            65535,
                                            2147483647,
                                            -2147483648LL,
                                            4294967296,
                                            1e30,
                                            -1e30,
                                            1e-30,
                                            1e308,
                                            -1e308,
                                            1e-308,
                                            5120,
                                            5121,
                                            5123,
                                            5125,
                                            5126,
                                            0.5,
                                            1.0001,
                                            1e6,
                                            1e10,
                                            9007199254740993LL,
                                            3.4028235e38,
                                            1e39,
                                            1e-45};
    switch (below(random, 4)) {
    case 0:
        return old.is_number_integer() ? Json(old.get<int64_t>() / 2 + 1)
                                       : Json(old.get<double>() * 2);
    case 1:
        return old.is_number_integer() ? Json(old.get<int64_t>() ^ 1) : Json(-old.get<double>());
    default:
        return kEnds[below(random, kEnds.size())];
    }
}

void mutate_text(Json& json, Random& random) {
    static const std::string kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/=";
    std::string text = json.get<std::string>();
    const size_t comma = text.starts_with("data:") ? text.find(',') + 1 : 0;
    if (text.size() > comma)
        text[comma + below(random, text.size() - comma)] = kDigits[below(random, kDigits.size())];
    json = text;
}

void mutate_container(Json& json, Random& random) {
    if (json.empty()) return;
    const size_t at = below(random, json.size());
    auto it = std::next(json.begin(), std::ptrdiff_t(at));
    switch (below(random, 3)) {
    case 0:
        json.erase(it);
        break;
    case 1:
        if (json.is_array())
            json.push_back(Json(*it));
        else
            json[it.key() + "_"] = Json(*it);
        break;
    default:
        *it = nullptr;
    }
}

void mutate_once(Json& json, Random& random) {
    std::vector<Json*> values;
    collect(json, values);
    Json& value = *values[below(random, values.size())];
    if (below(random, 8) == 0) {
        // Put another part of the file here.
        const Json other = *values[below(random, values.size())];
        if (other.dump().size() < 4096) value = other;
    } else if (value.is_number()) {
        value = number_like(value, random);
    } else if (value.is_string()) {
        mutate_text(value, random);
    } else if (value.is_structured()) {
        mutate_container(value, random);
    } else if (value.is_boolean()) {
        value = !value.get<bool>();
    } else {
        value = 0;
    }
}

uint32_t word_at(const uint8_t* data) {
    uint32_t word;
    std::memcpy(&word, data, sizeof word);
    return word;
}

// Where the JSON of a GLB or glTF lies.
struct Extent {
    size_t begin, size;
};
Extent json_extent(const uint8_t* data, size_t size) {
    if (size < kGlbHeaderBytes || std::memcmp(data, "glTF", 4) != 0) return {0, size};
    return {kGlbHeaderBytes, std::min<size_t>(word_at(data + 12), size - kGlbHeaderBytes)};
}

// The file with other JSON; GLB lengths follow.
std::vector<uint8_t> with_json(const uint8_t* data, size_t size, Extent extent, std::string text) {
    if (extent.begin > 0) text.resize((text.size() + 3) / 4 * 4, ' ');
    std::vector<uint8_t> out(data, data + extent.begin);
    out.insert(out.end(), text.begin(), text.end());
    out.insert(out.end(), data + extent.begin + extent.size, data + size);
    if (extent.begin == 0) return out;
    const auto total = uint32_t(out.size()), chunk = uint32_t(text.size());
    std::memcpy(&out[8], &total, sizeof total);
    std::memcpy(&out[12], &chunk, sizeof chunk);
    return out;
}

} // namespace

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t max_size,
                                          unsigned int seed) {
    Random random(seed + 1);
    if (size == 0 || below(random, 4) == 0) return LLVMFuzzerMutate(data, size, max_size);
    const Extent extent = json_extent(data, size);
    const char* const text = reinterpret_cast<const char*>(data) + extent.begin;
    Json json = Json::parse(text, text + extent.size, nullptr, false);
    if (json.is_discarded() || !json.is_structured()) return LLVMFuzzerMutate(data, size, max_size);
    for (size_t i = 0, n = 1 + below(random, 3); i < n; ++i)
        mutate_once(json, random);
    const std::vector<uint8_t> out =
        with_json(data, size, extent, json.dump(-1, ' ', false, Json::error_handler_t::replace));
    if (out.size() > max_size) return LLVMFuzzerMutate(data, size, max_size);
    std::copy(out.begin(), out.end(), data);
    return out.size();
}
