#include "geometry/embree_scene.h"

#include "base/check.h"
#include "geometry/quadric.h"

#include <embree3/rtcore.h>

#include <cmath>
#include <optional>

namespace ql {

struct EmbreeScene::Impl {
    const World* world = nullptr;
    const AlphaTest* alpha_test = nullptr;
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    std::vector<RTCScene> shared_scenes; // of instanced meshes, by mesh

    Impl() = default;
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    ~Impl() {
        if (scene) rtcReleaseScene(scene);
        for (const RTCScene shared : shared_scenes)
            if (shared) rtcReleaseScene(shared);
        if (device) rtcReleaseDevice(device);
    }
};

namespace {

// What callbacks need beside Embree's own context, which must come first. The id of a ray is its
// alpha key.
struct RayContext {
    RTCIntersectContext embree;
    const EmbreeScene::Impl* scene;
};

// A well-mixed 24-bit fraction from the ray's key and the place it met.
float alpha_random(uint32_t key, uint32_t surface, uint32_t primitive) {
    uint32_t h = key ^ (surface * 0x9e3779b9u) ^ (primitive * 0x85ebca6bu);
    h ^= h >> 16;
    h *= 0x7feb352du;
    h ^= h >> 15;
    h *= 0x846ca68bu;
    h ^= h >> 16;
    return float(h >> 8) * 0x1p-24f;
}

void filter_alpha(const RTCFilterFunctionNArguments* arguments) {
    const EmbreeScene::Impl& scene =
        *reinterpret_cast<const RayContext*>(arguments->context)->scene;
    const unsigned n = arguments->N;
    RTCHitN* hit = arguments->hit;
    for (unsigned i = 0; i < n; ++i) {
        if (arguments->valid[i] == 0) continue;
        const uint32_t instance = RTCHitN_instID(hit, n, i, 0);
        const uint32_t surface =
            instance != RTC_INVALID_GEOMETRY_ID ? instance : RTCHitN_geomID(hit, n, i);
        const uint32_t primitive = RTCHitN_primID(hit, n, i);
        const float random = alpha_random(RTCRayN_id(arguments->ray, n, i), surface, primitive);
        const bool solid = scene.alpha_test->is_solid(
            *scene.world, surface, primitive, RTCHitN_u(hit, n, i), RTCHitN_v(hit, n, i), random);
        if (!solid) arguments->valid[i] = 0;
    }
}

void shape_bounds_callback(const RTCBoundsFunctionArguments* arguments) {
    const auto& surface = *static_cast<const Surface*>(arguments->geometryUserPtr);
    const V3d h = half_extent(*surface.implicit);
    Imath::Box3d box;
    for (int corner = 0; corner < 8; ++corner)
        box.extendBy(surface.render_from_body.point(
            {corner & 1 ? h.x : -h.x, corner & 2 ? h.y : -h.y, corner & 4 ? h.z : -h.z}));
    // Rounded outwards, so that the float box holds the shape.
    const auto below = [](double x) { return std::nextafter(float(x), -kInfinity); };
    const auto above = [](double x) { return std::nextafter(float(x), kInfinity); };
    RTCBounds& bounds = *arguments->bounds_o;
    bounds.lower_x = below(box.min.x);
    bounds.lower_y = below(box.min.y);
    bounds.lower_z = below(box.min.z);
    bounds.upper_x = above(box.max.x);
    bounds.upper_y = above(box.max.y);
    bounds.upper_z = above(box.max.z);
}

bool needs_alpha_test(const Material& material) {
    return material.alpha_mode != AlphaMode::opaque;
}

// The nearest crossing that is solid; each crossing is a decision of its own.
std::optional<QuadricHit> shape_hit(const RayContext& context, uint32_t index, RTCRayN* ray,
                                    unsigned n, unsigned i) {
    const EmbreeScene::Impl& scene = *context.scene;
    const Surface& surface = scene.world->surfaces[index];
    const V3d origin(RTCRayN_org_x(ray, n, i), RTCRayN_org_y(ray, n, i), RTCRayN_org_z(ray, n, i));
    const V3d direction(RTCRayN_dir_x(ray, n, i), RTCRayN_dir_y(ray, n, i),
                        RTCRayN_dir_z(ray, n, i));
    const V3d from = surface.body_from_render.point(origin);
    const V3d along = surface.body_from_render.vector(direction);
    const double t_far = double(RTCRayN_tfar(ray, n, i));
    double t_near = double(RTCRayN_tnear(ray, n, i));
    const bool solid = !scene.alpha_test ||
                       !needs_alpha_test(scene.world->scene->materials[size_t(surface.material)]);
    for (uint32_t crossing = 0;; ++crossing) {
        const auto hit = intersect_shape(*surface.implicit, from, along, t_near, t_far);
        if (!hit || solid ||
            scene.alpha_test->is_solid(*scene.world, index, 0, hit->uv.x, hit->uv.y,
                                       alpha_random(RTCRayN_id(ray, n, i), index, crossing)))
            return hit;
        t_near = std::nextafter(hit->t, double(kInfinity)); // intersect_shape() rounds
    }
}

void intersect_shape_callback(const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    QL_DCHECK(arguments->N == 1);
    const auto& surface = *static_cast<const Surface*>(arguments->geometryUserPtr);
    RTCRayN* ray = RTCRayHitN_RayN(arguments->rayhit, arguments->N);
    RTCHitN* hit = RTCRayHitN_HitN(arguments->rayhit, arguments->N);
    const auto& context = *reinterpret_cast<const RayContext*>(arguments->context);
    const auto found = shape_hit(context, arguments->geomID, ray, 1, 0);
    if (!found) return;
    const Imath::M33f& m = surface.render_from_normal;
    const V3f n(found->normal);
    RTCRayN_tfar(ray, 1, 0) = float(found->t);
    RTCHitN_Ng_x(hit, 1, 0) = m[0][0] * n.x + m[0][1] * n.y + m[0][2] * n.z;
    RTCHitN_Ng_y(hit, 1, 0) = m[1][0] * n.x + m[1][1] * n.y + m[1][2] * n.z;
    RTCHitN_Ng_z(hit, 1, 0) = m[2][0] * n.x + m[2][1] * n.y + m[2][2] * n.z;
    RTCHitN_u(hit, 1, 0) = found->uv.x;
    RTCHitN_v(hit, 1, 0) = found->uv.y;
    RTCHitN_primID(hit, 1, 0) = arguments->primID;
    RTCHitN_geomID(hit, 1, 0) = arguments->geomID;
    RTCHitN_instID(hit, 1, 0, 0) = RTC_INVALID_GEOMETRY_ID;
}

void occluded_shape_callback(const RTCOccludedFunctionNArguments* arguments) {
    const auto& context = *reinterpret_cast<const RayContext*>(arguments->context);
    const unsigned n = arguments->N;
    for (unsigned i = 0; i < n; ++i)
        if (arguments->valid[i] != 0 && shape_hit(context, arguments->geomID, arguments->ray, n, i))
            RTCRayN_tfar(arguments->ray, n, i) = -kInfinity;
}

RTCGeometry triangle_geometry(RTCDevice device, const Body& body, const Mesh& mesh) {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Shared buffers: Embree reads ours. Body keeps one spare position behind the last vertex.
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               body.positions.data(), 0, sizeof(V3f), mesh.positions.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               mesh.triangles.data(), 0, 3 * sizeof(uint32_t),
                               mesh.triangles.size());
    return geometry;
}

RTCScene new_scene(RTCDevice device) {
    const RTCScene scene = rtcNewScene(device);
    // Robust: no gaps along shared edges. Medium quality builds are the same for any thread count.
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
    return scene;
}

void attach(RTCScene scene, RTCGeometry geometry, uint32_t id) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);
}

void set_alpha_filter(const EmbreeScene::Impl& impl, RTCGeometry geometry, int material) {
    if (!impl.alpha_test || !needs_alpha_test(impl.world->scene->materials[size_t(material)]))
        return;
    rtcSetGeometryIntersectFilterFunction(geometry, filter_alpha);
    rtcSetGeometryOccludedFilterFunction(geometry, filter_alpha);
}

RTCGeometry shape_geometry(const EmbreeScene::Impl& impl, const Surface& surface) {
    const RTCGeometry geometry = rtcNewGeometry(impl.device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, 1);
    rtcSetGeometryUserData(geometry, const_cast<Surface*>(&surface));
    rtcSetGeometryBoundsFunction(geometry, shape_bounds_callback, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect_shape_callback);
    rtcSetGeometryOccludedFunction(geometry, occluded_shape_callback);
    return geometry;
}

RTCGeometry instance_geometry(EmbreeScene::Impl& impl, const Surface& surface) {
    const Mesh& mesh = impl.world->scene->meshes[size_t(surface.mesh)];
    RTCScene& shared = impl.shared_scenes[size_t(surface.mesh)];
    if (!shared) {
        shared = new_scene(impl.device);
        const RTCGeometry geometry = triangle_geometry(impl.device, *surface.body, mesh);
        set_alpha_filter(impl, geometry, mesh.material);
        attach(shared, geometry, 0);
        rtcCommitScene(shared);
    }
    const RTCGeometry instance = rtcNewGeometry(impl.device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, shared);
    const Affine& t = surface.render_from_body;
    float columns[12];
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            columns[column * 3 + row] = float(t.linear[row][column]);
    for (int row = 0; row < 3; ++row)
        columns[9 + row] = float(t.translation[row]);
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
    return instance;
}

// Whatever Embree cannot do on a machine that it runs on, it lacks memory or threads for.
void throw_embree_error(RTCDevice device, const char* what) {
    const RTCError error = rtcGetDeviceError(device);
    if (device && error == RTC_ERROR_NONE) return;
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    if (error == RTC_ERROR_UNSUPPORTED_CPU || error == RTC_ERROR_INVALID_ARGUMENT ||
        error == RTC_ERROR_INVALID_OPERATION)
        throw Error(ErrorKind::internal, fmt::format("Embree {} (error {})", what, int(error)));
    throw output_error("Embree {}: no memory or threads to be had", what);
}

RTCIntersectContext plain_context() {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    return context;
}

void set_ray(RTCRay& to, const Ray& from, uint32_t alpha_key) {
    to.org_x = from.origin.x;
    to.org_y = from.origin.y;
    to.org_z = from.origin.z;
    to.tnear = from.t_near;
    to.dir_x = from.direction.x;
    to.dir_y = from.direction.y;
    to.dir_z = from.direction.z;
    to.time = 0;
    to.tfar = from.t_far;
    to.mask = ~0u;
    to.id = alpha_key;
    to.flags = 0;
}

void set_lane(RTCRay8& to, size_t i, const Ray& from, uint32_t alpha_key) {
    to.org_x[i] = from.origin.x;
    to.org_y[i] = from.origin.y;
    to.org_z[i] = from.origin.z;
    to.tnear[i] = from.t_near;
    to.dir_x[i] = from.direction.x;
    to.dir_y[i] = from.direction.y;
    to.dir_z[i] = from.direction.z;
    to.time[i] = 0;
    to.tfar[i] = from.t_far;
    to.mask[i] = ~0u;
    to.id[i] = alpha_key;
    to.flags[i] = 0;
}

} // namespace

EmbreeScene::EmbreeScene(const World& world, const AlphaTest* alpha_test, const Workers& workers)
    : m_impl(std::make_unique<Impl>()) {
    Impl& impl = *m_impl;
    impl.world = &world;
    impl.alpha_test = alpha_test;
    const std::string settings = fmt::format("threads={}", workers.count());
    impl.device = rtcNewDevice(settings.c_str());
    if (!impl.device) throw_embree_error(nullptr, "cannot start");
    impl.scene = new_scene(impl.device);
    impl.shared_scenes.resize(world.scene->meshes.size(), nullptr);
    workers.run([&] {
        for (uint32_t i = 0; i < world.surfaces.size(); ++i) {
            const Surface& surface = world.surfaces[i];
            RTCGeometry geometry = nullptr;
            if (surface.kind != Surface::Kind::triangles)
                geometry = shape_geometry(impl, surface);
            else if (surface.instanced)
                geometry = instance_geometry(impl, surface);
            else
                geometry = triangle_geometry(impl.device, *surface.body,
                                             world.scene->meshes[size_t(surface.mesh)]);
            if (surface.kind == Surface::Kind::triangles && !surface.instanced)
                set_alpha_filter(impl, geometry, surface.material);
            attach(impl.scene, geometry, i);
        }
        rtcCommitScene(impl.scene);
    });
    throw_embree_error(impl.device, "cannot build the scene");
}

EmbreeScene::~EmbreeScene() = default;
EmbreeScene::EmbreeScene(EmbreeScene&&) noexcept = default;
EmbreeScene& EmbreeScene::operator=(EmbreeScene&&) noexcept = default;

bool EmbreeScene::intersect(const Ray& ray, uint32_t alpha_key, Hit& hit) const {
    RayContext context{plain_context(), m_impl.get()};
    RTCRayHit query;
    set_ray(query.ray, ray, alpha_key);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(m_impl->scene, &context.embree, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    hit.t = query.ray.tfar;
    hit.u = query.hit.u;
    hit.v = query.hit.v;
    hit.primitive = query.hit.primID;
    hit.surface =
        query.hit.instID[0] != RTC_INVALID_GEOMETRY_ID ? query.hit.instID[0] : query.hit.geomID;
    hit.ng = {query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z};
    return true;
}

bool EmbreeScene::is_occluded(const Ray& ray, uint32_t alpha_key) const {
    RayContext context{plain_context(), m_impl.get()};
    RTCRay query;
    set_ray(query, ray, alpha_key);
    rtcOccluded1(m_impl->scene, &context.embree, &query);
    return query.tfar < 0;
}

uint32_t EmbreeScene::occluded(std::span<const Ray> rays, const uint32_t* alpha_keys) const {
    QL_DCHECK(!rays.empty() && rays.size() <= kPacketRays);
    if (rays.size() == 1) return is_occluded(rays[0], alpha_keys[0]) ? 1 : 0;
    RayContext context{plain_context(), m_impl.get()};
    RTCRay8 query;
    alignas(32) int valid[kPacketRays];
    for (size_t i = 0; i < kPacketRays; ++i) {
        // Lanes without a ray hold the first one, switched off.
        const bool is_there = i < rays.size();
        set_lane(query, i, rays[is_there ? i : 0], alpha_keys[is_there ? i : 0]);
        valid[i] = is_there ? -1 : 0;
    }
    rtcOccluded8(valid, m_impl->scene, &context.embree, &query);
    uint32_t blocked = 0;
    for (size_t i = 0; i < rays.size(); ++i)
        blocked |= uint32_t{query.tfar[i] < 0} << i;
    return blocked;
}

const World& EmbreeScene::world() const {
    return *m_impl->world;
}

std::string embree_version() {
    return "Embree " RTC_VERSION_STRING;
}

} // namespace ql
