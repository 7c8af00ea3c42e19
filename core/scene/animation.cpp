#include "scene/scene.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>

namespace ql {

namespace {

using Value = std::array<double, 4>;
using Imath::Quatd;

Value combination(double a, const Value& x, double b, const Value& y) {
    Value result;
    for (size_t c = 0; c < result.size(); ++c)
        result[c] = a * x[c] + b * y[c];
    return result;
}

double dot(const Value& a, const Value& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

Value unit(const Value& q) {
    return combination(1 / std::sqrt(dot(q, q)), q, 0, q);
}

// Along the shorter great circle. The angle comes from both chord lengths, which is accurate for
// small and for large angles.
Value slerp(Value a, Value b, double t) {
    a = unit(a);
    b = unit(b);
    if (dot(a, b) < 0) b = combination(-1, b, 0, b);
    const Value difference = combination(1, b, -1, a);
    const Value sum = combination(1, b, 1, a);
    const double angle =
        2 * std::atan2(std::sqrt(dot(difference, difference)), std::sqrt(dot(sum, sum)));
    if (angle == 0) return a;
    const double sine = std::sin(angle);
    return combination(std::sin((1 - t) * angle) / sine, a, std::sin(t * angle) / sine, b);
}

// Hermite spline (glTF 2.0, appendix C.4): tangents are per second, so they are scaled by the
// distance of the keys.
Value hermite(const AnimationChannel& channel, size_t key, double t) {
    const double seconds = channel.times[key + 1] - channel.times[key];
    const Value& value0 = channel.values[key * 3 + 1];
    const Value& out0 = channel.values[key * 3 + 2];
    const Value& in1 = channel.values[key * 3 + 3];
    const Value& value1 = channel.values[key * 3 + 4];
    const double t2 = t * t;
    const double t3 = t2 * t;
    const Value values = combination(2 * t3 - 3 * t2 + 1, value0, -2 * t3 + 3 * t2, value1);
    const Value tangents = combination(seconds * (t3 - 2 * t2 + t), out0, seconds * (t3 - t2), in1);
    return combination(1, values, 1, tangents);
}

Value key_value(const AnimationChannel& channel, size_t key) {
    const bool cubic = channel.interpolation == AnimationChannel::Interpolation::cubic_spline;
    return channel.values[cubic ? key * 3 + 1 : key];
}

Value value_at(const AnimationChannel& channel, double time) {
    using Interpolation = AnimationChannel::Interpolation;
    const auto& times = channel.times;
    if (time <= times.front()) return key_value(channel, 0);
    if (time >= times.back()) return key_value(channel, times.size() - 1);
    const auto after = std::upper_bound(times.begin(), times.end(), time);
    const size_t key = size_t(after - times.begin()) - 1;
    if (channel.interpolation == Interpolation::step) return key_value(channel, key);
    const double t = (time - times[key]) / (times[key + 1] - times[key]);
    if (channel.interpolation == Interpolation::cubic_spline) return hermite(channel, key, t);
    const Value a = key_value(channel, key);
    const Value b = key_value(channel, key + 1);
    return channel.path == AnimationChannel::Path::rotation ? slerp(a, b, t)
                                                            : combination(1 - t, a, t, b);
}

void apply(const AnimationChannel& channel, double time, Node& node) {
    const Value v = value_at(channel, time);
    switch (channel.path) {
    case AnimationChannel::Path::translation:
        node.translation = V3d(v[0], v[1], v[2]);
        break;
    case AnimationChannel::Path::scale:
        node.scale = V3d(v[0], v[1], v[2]);
        break;
    case AnimationChannel::Path::rotation:
        node.rotation = Quatd(v[3], v[0], v[1], v[2]);
        break;
    }
}

M44d parent_from_node(const Node& node) {
    if (node.matrix) return *node.matrix;
    Quatd rotation = node.rotation;
    const double length = rotation.length(); // a spline between rotations leaves the unit sphere
    if (length > 0) rotation /= length;
    M44d scale;
    scale.setScale(node.scale);
    M44d translation;
    translation.setTranslation(node.translation);
    return scale * rotation.toMatrix44() * translation;
}

// Beyond this the products that normals are made of leave the range of double.
constexpr double kMaxEntry = 1e100;

void check_pose(const M44d& pose, const Node& node, size_t index) {
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 3; ++column)
            if (!(std::abs(pose[row][column]) <= kMaxEntry))
                throw input_error("node {} '{}': {} in its transform to the world, expected at "
                                  "most {}",
                                  index, node.name, pose[row][column], kMaxEntry);
}

} // namespace

std::vector<M44d> world_from_nodes(const Scene& scene, double time_seconds) {
    std::vector<Node> moved;
    const std::vector<Node>* nodes = &scene.nodes;
    if (!scene.animation.empty()) {
        moved = scene.nodes;
        for (const AnimationChannel& channel : scene.animation)
            apply(channel, time_seconds, moved[size_t(channel.node)]);
        nodes = &moved;
    }
    std::vector<M44d> world(nodes->size());
    for (size_t i = 0; i < nodes->size(); ++i) {
        const Node& node = (*nodes)[i];
        world[i] = parent_from_node(node);
        if (node.parent >= 0) world[i] = world[i] * world[size_t(node.parent)];
        check_pose(world[i], node, i);
    }
    return world;
}

} // namespace ql
