#include "scene/gltf_animation.h"

#include "scene/gltf_accessor.h"

#include <tiny_gltf.h>

#include <cmath>
#include <optional>
#include <set>

namespace ql {

namespace {

using Path = AnimationChannel::Path;
using Interpolation = AnimationChannel::Interpolation;

std::optional<Path> path_of(const std::string& name) {
    if (name == "translation") return Path::translation;
    if (name == "rotation") return Path::rotation;
    if (name == "scale") return Path::scale;
    return std::nullopt;
}

Interpolation interpolation_of(const GltfImport& in, const std::string& name,
                               const std::string& where) {
    if (name == "LINEAR") return Interpolation::linear;
    if (name == "STEP") return Interpolation::step;
    if (name == "CUBICSPLINE") return Interpolation::cubic_spline;
    throw in.error("{}: interpolation {}, expected LINEAR, STEP or CUBICSPLINE", where, name);
}

std::vector<double> read_times(GltfImport& in, int accessor, const std::string& where) {
    std::vector<double> times =
        read_accessor<double>(in, accessor, {where + " times", 1, 1, IntegerRule::refused}).values;
    if (times.empty()) throw in.error("{}: no keys", where);
    for (size_t i = 0; i < times.size(); ++i)
        if (!std::isfinite(times[i]) || (i > 0 && times[i] <= times[i - 1]))
            throw in.error("{}: time {} of key {}, expected finite and ascending times", where,
                           times[i], i);
    return times;
}

void read_values(GltfImport& in, int accessor, const std::string& where,
                 AnimationChannel& channel) {
    const bool rotation = channel.path == Path::rotation;
    const bool cubic = channel.interpolation == Interpolation::cubic_spline;
    const int components = rotation ? 4 : 3;
    const auto read = read_accessor<double>(
        in, accessor, {where + " values", components, components, IntegerRule::normalized});
    const size_t expected = channel.times.size() * (cubic ? 3 : 1);
    if (read.count != expected)
        throw in.error("{}: {} values for {} keys, expected {}", where, read.count,
                       channel.times.size(), expected);
    channel.values.assign(read.count, {});
    for (size_t i = 0; i < read.count; ++i) {
        double length2 = 0;
        for (size_t c = 0; c < size_t(components); ++c) {
            const double value = read.values[i * size_t(components) + c];
            if (!std::isfinite(value)) throw in.error("{}: value {} is not finite", where, i);
            channel.values[i][c] = value;
            length2 += value * value;
        }
        const bool is_tangent = cubic && i % 3 != 1;
        if (rotation && !is_tangent && !(length2 > 0))
            throw in.error("{}: rotation {} is zero", where, i);
    }
}

AnimationChannel channel_from(GltfImport& in, const tinygltf::AnimationSampler& sampler, int node,
                              Path path, const std::string& where) {
    AnimationChannel channel;
    channel.node = node;
    channel.path = path;
    channel.interpolation = interpolation_of(in, sampler.interpolation, where);
    channel.times = read_times(in, sampler.input, where);
    read_values(in, sampler.output, where, channel);
    return channel;
}

} // namespace

void import_animations(GltfImport& in) {
    std::set<std::pair<int, Path>> moved;
    for (size_t a = 0; a < in.model.animations.size(); ++a) {
        const tinygltf::Animation& animation = in.model.animations[a];
        for (size_t c = 0; c < animation.channels.size(); ++c) {
            const tinygltf::AnimationChannel& source = animation.channels[c];
            const std::string where = fmt::format("animation {} channel {}", a, c);
            const auto& sampler = in.at(animation.samplers, source.sampler, where, "sampler");
            if (source.target_node < 0) continue; // left to extensions, which are warned of
            in.at(in.model.nodes, source.target_node, where, "node");
            const int node = in.nodes[size_t(source.target_node)];
            const std::optional<Path> path = path_of(source.target_path);
            if (node < 0) continue; // not in the default scene
            if (!path) {
                in.warn("{}: {} are not animated (rest pose)", where, source.target_path);
                continue;
            }
            if (in.scene.nodes[size_t(node)].matrix)
                throw in.error("{}: moves node {}, which has a matrix", where, source.target_node);
            if (!moved.insert({node, *path}).second) {
                in.warn("{}: node {} is moved by an earlier channel, left out", where,
                        source.target_node);
                continue;
            }
            in.scene.animation.push_back(channel_from(in, sampler, node, *path, where));
        }
    }
}

} // namespace ql
