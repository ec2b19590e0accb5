// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/SurfacePicture.h"

#include "Explica/Core/EigenViews.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"

#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <unordered_map>

namespace explica::report {
namespace {

constexpr int kSkyRays = 12;           // a vertex; neighbours are averaged afterwards
constexpr int kSkySmoothing = 2;       // passes
constexpr double kSkyReach = 0.10;     // of the surface's diagonal
constexpr float kNotMeasured = -1;     // of a length of a ray
constexpr double kMargin = 1.04;       // of the picture around the surface
constexpr int kTile = 32;              // pixels; one task
constexpr double kBorder = 1.6;        // pixels: width of the line between two regions
constexpr float kBorderShade = 0.15F;  // what it leaves of the colour

/// Embree's traversal wants denormals flushed; our own arithmetic must not be left that way.
class FlushDenormals {
 public:
  FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040); }
  ~FlushDenormals() { _mm_setcsr(before_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned before_;
};

struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceRelease>;
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneRelease>;

RTCRayHit rayFrom(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near,
                  float far) {
  RTCRayHit query;
  std::memset(&query, 0, sizeof query);
  query.ray.org_x = origin.x();
  query.ray.org_y = origin.y();
  query.ray.org_z = origin.z();
  query.ray.dir_x = direction.x();
  query.ray.dir_y = direction.y();
  query.ray.dir_z = direction.z();
  query.ray.tnear = near;
  query.ray.tfar = far;
  query.ray.mask = 0xffffffffu;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return query;
}

/// Cosine-weighted directions about +z: a spiral that covers the disc evenly.
std::array<Eigen::Vector3f, kSkyRays> skyDirections() {
  std::array<Eigen::Vector3f, kSkyRays> directions;
  for (int r = 0; r < kSkyRays; ++r) {
    const double radius = std::sqrt((r + 0.5) / kSkyRays);
    const double angle = r * kPi * (3 - std::sqrt(5.0));
    directions[r] = Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle),
                                    std::sqrt(std::max(0.0, 1 - radius * radius)))
                        .cast<float>();
  }
  return directions;
}

Eigen::Vector3f perpendicular(const Eigen::Vector3f& n) {
  return n.cross(std::abs(n.x()) < 0.7f ? Eigen::Vector3f::UnitX() : Eigen::Vector3f::UnitY())
      .normalized();
}

using FloatPositions = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Faces that rays meet: those of a surface that stay, or those that move.
struct Layer {
  std::vector<std::int32_t> faces;  ///< which of the surface's
  Scene scene;

  /// @param id  what rays that meet them get as `geomID`
  void build(RTCDevice device, unsigned id, const FloatPositions& positions, const Faces& all);
};

void Layer::build(RTCDevice device, unsigned id, const FloatPositions& positions,
                  const Faces& all) {
  scene.reset(rtcNewScene(device));
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  if (!faces.empty()) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), static_cast<std::size_t>(positions.rows())));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), faces.size()));
    if (vertices == nullptr || indices == nullptr) {
      rtcReleaseGeometry(geometry);
      throw EnvironmentError("not enough memory to draw a surface of " +
                             std::to_string(all.rows()) + " faces");
    }
    std::copy(positions.data(), positions.data() + positions.size(), vertices);
    for (const std::int32_t f : faces) {
      for (int k = 0; k < 3; ++k) *indices++ = static_cast<unsigned>(all(f, k));
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene.get(), geometry, id);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene.get());
}

}  // namespace

struct SurfaceScene::Implementation {
  FloatPositions positions;
  FloatPositions normals;
  Faces faces;
  std::vector<std::uint8_t> moves;  ///< of each vertex; none: all stay
  std::vector<std::uint8_t> turns;  ///< of each vertex whether it is of a face that moves
  std::vector<float> clear;         ///< mm along each vertex's rays to the first face that stays
  std::vector<float> openness;      ///< share of the sky that each vertex and those about it see
  double diagonal = 1;
  float skyReach = 0;  ///< of the rays into the sky, mm
  Device device;
  Layer still, moving;

  void build(const TriangleMesh& mesh);
  void moveTo(const TriangleMesh& mesh);
  void place(const TriangleMesh& mesh);
  void measureOpenness();
  struct Tint;
  /// Of each face a bit for each edge, opposite to its first, second and third corner: whether it
  /// is the only face at that edge without a corner of key 0, or beside that face.
  [[nodiscard]] std::vector<std::uint8_t> rimOf(const std::vector<std::int32_t>& keys) const;
  [[nodiscard]] bool isWithin(Eigen::Index face, const std::vector<std::int32_t>& keys) const {
    return keys[faces(face, 0)] != 0 && keys[faces(face, 1)] != 0 && keys[faces(face, 2)] != 0;
  }
};

/// What colours a surface's points.
struct SurfaceScene::Implementation::Tint {
  const std::vector<Colour>& colours;  ///< one a vertex, or none
  Filling filling;
  const std::vector<std::int32_t>& keys;  ///< one a vertex, or none
  std::vector<std::uint8_t> rim;          ///< see rimOf()
  double reach = 0;                       ///< mm, half the line

  [[nodiscard]] Colour at(const Implementation& surface, Eigen::Index face,
                          const std::array<float, 3>& weight) const;

 private:
  [[nodiscard]] bool onLine(const Implementation& surface, Eigen::Index face,
                            const std::array<float, 3>& weight) const;
};

void SurfaceScene::Implementation::build(const TriangleMesh& mesh) {
  if (mesh.faceCount() == 0) throw InvalidInput("surface: no faces to draw");
  faces = mesh.faces;
  diagonal = boundingBox(mesh.positions).sizes().norm();
  skyReach = static_cast<float>(kSkyReach * diagonal);
  device.reset(rtcNewDevice(nullptr));
  if (!device && rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (!device) throw EnvironmentError("Embree cannot start on this processor; pictures need it");

  moves.resize(static_cast<std::size_t>(mesh.vertexCount()), 0);
  turns = moves;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const bool isMoving =
        moves[faces(f, 0)] != 0 || moves[faces(f, 1)] != 0 || moves[faces(f, 2)] != 0;
    (isMoving ? moving : still).faces.push_back(static_cast<std::int32_t>(f));
    for (int k = 0; k < 3 && isMoving; ++k) turns[faces(f, k)] = 1;
  }
  place(mesh);
  still.build(device.get(), 0, positions, faces);
  moving.build(device.get(), 1, positions, faces);
  clear.assign(moves.size() * kSkyRays, kNotMeasured);
  measureOpenness();
}

void SurfaceScene::Implementation::place(const TriangleMesh& mesh) {
  if (!mesh.positions.allFinite()) throw InvalidInput("surface: a vertex's position is not finite");
  positions = mesh.positions.cast<float>();
  normals = geometry::vertexNormals(mesh).cast<float>();
}

void SurfaceScene::Implementation::moveTo(const TriangleMesh& mesh) {
  if (mesh.faces != faces) throw InvalidInput("surface: its faces are not those of before");
  const FloatPositions before = positions;
  place(mesh);
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    if (moves[v] == 0 && positions.row(v) != before.row(v)) {
      throw InvalidInput("surface: vertex " + std::to_string(v) + " was to stay where it is");
    }
  }
  moving.build(device.get(), 1, positions, faces);
  measureOpenness();
}

std::vector<std::uint8_t> SurfaceScene::Implementation::rimOf(
    const std::vector<std::int32_t>& keys) const {
  std::unordered_map<std::uint64_t, int> count;  // of faces within, by edge
  const auto edgeOf = [&](Eigen::Index face, int k) {
    const auto [low, high] = std::minmax(faces(face, (k + 1) % 3), faces(face, (k + 2) % 3));
    return static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint32_t>(high);
  };
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3 && isWithin(f, keys); ++k) ++count[edgeOf(f, k)];
  }
  std::vector<std::uint8_t> rim(static_cast<std::size_t>(faces.rows()), 0);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    if (keys[faces(f, 0)] == 0 && keys[faces(f, 1)] == 0) continue;  // no edge within
    for (int k = 0; k < 3; ++k) {
      const auto found = count.find(edgeOf(f, k));
      if (found != count.end() && found->second == 1) rim[f] |= static_cast<std::uint8_t>(1 << k);
    }
  }
  return rim;
}

bool SurfaceScene::Implementation::Tint::onLine(const Implementation& surface, Eigen::Index face,
                                                const std::array<float, 3>& weight) const {
  if (rim[face] == 0) return false;
  std::array<Eigen::Vector3f, 3> corner;
  for (int k = 0; k < 3; ++k) corner[k] = surface.positions.row(surface.faces(face, k)).transpose();
  const float twice = (corner[1] - corner[0]).cross(corner[2] - corner[0]).norm();
  for (int k = 0; k < 3; ++k) {
    const float edge = (corner[(k + 1) % 3] - corner[(k + 2) % 3]).norm();
    if ((rim[face] >> k & 1) != 0 && weight[k] * twice < reach * edge) return true;
  }
  return false;
}

Colour SurfaceScene::Implementation::Tint::at(const Implementation& surface, Eigen::Index face,
                                              const std::array<float, 3>& weight) const {
  constexpr Colour kPlain = {0.60f, 0.58f, 0.56f};
  const bool outside = !keys.empty() && !surface.isWithin(face, keys);
  const auto nearest = static_cast<int>(std::ranges::max_element(weight) - weight.begin());
  Colour base = kPlain;
  if (!colours.empty() && filling == Filling::Discrete && !outside) {
    base = colours[surface.faces(face, nearest)];
  } else if (!colours.empty()) {
    constexpr float kLeast = 1e-6f;  // a point on the edge between two corners within
    base = {0, 0, 0};
    float sum = 0;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = surface.faces(face, k);
      if (outside && keys[v] != 0) continue;
      const float share = outside ? weight[k] + kLeast : weight[k];
      for (int c = 0; c < 3; ++c) base[c] += share * colours[v][c];
      sum += share;
    }
    for (float& c : base) c /= sum;
  }
  if (!keys.empty() && onLine(surface, face, weight)) {
    for (float& c : base) c *= kBorderShade;
  }
  return base;
}

void SurfaceScene::Implementation::measureOpenness() {
  const std::size_t count = moves.size();
  const auto lift = static_cast<float>(1e-4 * diagonal);
  const auto directions = skyDirections();
  Eigen::AlignedBox3f moved;
  for (std::size_t v = 0; v < count; ++v) {
    if (turns[v] != 0) moved.extend(positions.row(v).transpose());
  }
  std::vector<float> sky(count, 1.0f);  // share that each vertex sees
  parallelForBlocks(count, 2048, [&](std::size_t begin, std::size_t end) {
    const FlushDenormals flush;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (std::size_t v = begin; v < end; ++v) {
      const Eigen::Vector3f n = normals.row(v).transpose();
      if (n.squaredNorm() < 0.5f) continue;
      // A different turn at each vertex; averaging over neighbours then sees many directions.
      const auto turn = static_cast<float>(2 * kPi / 65536 * ((v * 2654435761u) & 0xffffu));
      const Eigen::Vector3f x = perpendicular(n), y = n.cross(x);
      const Eigen::Vector3f a = std::cos(turn) * x + std::sin(turn) * y, b = n.cross(a);
      const Eigen::Vector3f origin = positions.row(v).transpose() + lift * n;
      const bool isNear = !moved.isEmpty() && moved.exteriorDistance(origin) <= skyReach;
      float open = 0;
      for (int r = 0; r < kSkyRays; ++r) {
        const Eigen::Vector3f& d = directions[r];
        float& known = clear[v * kSkyRays + r];
        RTCRayHit query = rayFrom(origin, d.x() * a + d.y() * b + d.z() * n, 0, skyReach);
        if (turns[v] != 0 || known < 0) {
          rtcIntersect1(still.scene.get(), &context, &query);
          known = query.ray.tfar;
        }
        query.ray.tfar = known;
        if (isNear) rtcIntersect1(moving.scene.get(), &context, &query);
        // A wall far away hides less of the sky's light than one close by.
        open += query.ray.tfar / skyReach;
      }
      sky[v] = open / kSkyRays;
    }
  });
  // Averages over neighbours, over face corners so that non-manifold meshes can be drawn, too.
  openness = std::move(sky);
  for (int pass = 0; pass < kSkySmoothing; ++pass) {
    std::vector<float> sum(openness);
    std::vector<float> weight(count, 1.0f);
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const std::int32_t v = faces(f, k);
        sum[v] += openness[faces(f, (k + 1) % 3)];
        weight[v] += 1;
      }
    }
    for (std::size_t v = 0; v < count; ++v) openness[v] = sum[v] / weight[v];
  }
}

SurfaceScene::SurfaceScene(const TriangleMesh& mesh, const std::vector<std::uint8_t>& moves)
    : implementation_(std::make_unique<Implementation>()) {
  implementation_->moves = moves;
  implementation_->build(mesh);
}
void SurfaceScene::moveTo(const TriangleMesh& mesh) {
  implementation_->moveTo(mesh);
}
SurfaceScene::~SurfaceScene() = default;
SurfaceScene::SurfaceScene(SurfaceScene&&) noexcept = default;
SurfaceScene& SurfaceScene::operator=(SurfaceScene&&) noexcept = default;

const std::vector<float>& SurfaceScene::openness() const {
  return implementation_->openness;
}

Picture SurfaceScene::render(const Camera& camera, const std::vector<Colour>& colours,
                             Filling filling, const SurfacePictureOptions& options,
                             const std::vector<std::int32_t>& keys) const {
  const Implementation& self = *implementation_;
  if (!colours.empty() && colours.size() != static_cast<std::size_t>(self.positions.rows())) {
    throw InvalidInput("colours: found " + std::to_string(colours.size()) +
                       ", expected one for each of " + std::to_string(self.positions.rows()) +
                       " vertices");
  }
  if (!keys.empty() && keys.size() != static_cast<std::size_t>(self.positions.rows())) {
    throw InvalidInput("keys: found " + std::to_string(keys.size()) + ", expected one a vertex");
  }
  if (options.width < 1 || options.height < 1 || options.width > 20000 || options.height > 20000) {
    throw InvalidInput("width, height: must lie in 1 to 20000 pixels");
  }
  if (options.samples < 1 || options.samples > 8) throw InvalidInput("samples: must lie in 1 to 8");
  const Eigen::Vector3f towards = camera.towards.normalized().cast<float>();
  const Eigen::Vector3f up = camera.up.normalized().cast<float>();
  const Eigen::Vector3f right = towards.cross(up);
  const Eigen::Vector3f key = (-towards + 0.45f * up - 0.45f * right).normalized();
  const auto step = static_cast<float>(2 * camera.halfHeight / options.height / options.samples);
  const auto back = static_cast<float>(4 * self.diagonal);
  const Eigen::Vector3f corner =
      camera.target.cast<float>() - back * towards +
      (0.5f * static_cast<float>(options.height * options.samples) * step) * up -
      (0.5f * static_cast<float>(options.width * options.samples) * step) * right;
  const auto occlusion = static_cast<float>(options.occlusion);
  const Implementation::Tint paint{colours, filling, keys,
                                   keys.empty() ? std::vector<std::uint8_t>() : self.rimOf(keys),
                                   kBorder * camera.halfHeight / options.height};

  Picture picture(options.width, options.height);
  const int columns = (options.width + kTile - 1) / kTile;
  const int rows = (options.height + kTile - 1) / kTile;
  parallelFor(static_cast<std::size_t>(columns) * rows, 1, [&](std::size_t tile) {
    const FlushDenormals flush;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    const int x0 = static_cast<int>(tile % columns) * kTile;
    const int y0 = static_cast<int>(tile / columns) * kTile;
    const int x1 = std::min(x0 + kTile, options.width), ofPixel = options.samples * options.samples;
    const RTCRayHit blank = rayFrom(corner, towards, 0, 2 * back);
    std::vector<RTCRayHit> queries;  // of a row, which are followed together
    for (int y = y0; y < std::min(y0 + kTile, options.height); ++y) {
      queries.assign(static_cast<std::size_t>(x1 - x0) * ofPixel, blank);
      for (int q = 0; q < (x1 - x0) * ofPixel; ++q) {
        const int x = x0 + q / ofPixel, s = q % ofPixel;
        const float px = static_cast<float>(x * options.samples + s % options.samples) + 0.5f;
        const float py = static_cast<float>(y * options.samples + s / options.samples) + 0.5f;
        const Eigen::Vector3f from = corner + px * step * right - py * step * up;
        std::copy(from.data(), from.data() + 3, &queries[q].ray.org_x);
      }
      for (const Layer* layer : {&self.still, &self.moving}) {
        rtcIntersect1M(layer->scene.get(), &context, queries.data(),
                       static_cast<unsigned>(queries.size()), sizeof(RTCRayHit));
      }
      for (int x = x0; x < x1; ++x) {
        Colour sum = {0, 0, 0};
        for (int s = 0; s < ofPixel; ++s) {
          const RTCRayHit& query = queries[(x - x0) * ofPixel + s];
          if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
            for (float& c : sum) c += 1;
            continue;
          }
          const Layer& layer = query.hit.geomID == 0 ? self.still : self.moving;
          const Eigen::Index face = layer.faces[query.hit.primID];
          const std::array<float, 3> weight = {1 - query.hit.u - query.hit.v, query.hit.u,
                                               query.hit.v};
          Eigen::Vector3f normal = Eigen::Vector3f::Zero();
          float open = 0;
          for (int k = 0; k < 3; ++k) {
            const std::int32_t v = self.faces(face, k);
            normal += weight[k] * self.normals.row(v).transpose();
            open += weight[k] * self.openness[v];
          }
          const Colour base = paint.at(self, face, weight);
          const Eigen::Vector3f outward(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
          const bool inside = outward.dot(towards) > 0;
          normal.normalize();
          if (inside) normal = -normal;
          const float facing = std::max(0.0f, -normal.dot(towards));
          const float lit = 0.18f + 0.47f * std::max(0.0f, normal.dot(key)) + 0.40f * facing;
          const float dark = inside ? 0.5f : 1 - occlusion * (1 - std::min(1.0f, 1.25f * open));
          for (int c = 0; c < 3; ++c) {
            const float tint = inside ? (c == 2 ? 0.75f : 0.5f) : 1.0f;
            sum[c] += std::min(1.0f, tint * base[c] * lit * dark);
          }
        }
        if (sum[0] == ofPixel && sum[1] == ofPixel && sum[2] == ofPixel) continue;  // white paper
        std::uint8_t* pixel = picture.pixel(x, y);
        for (int c = 0; c < 3; ++c) pixel[c] = encodeSrgb(sum[c] / static_cast<float>(ofPixel));
      }
    }
  });
  return picture;
}

Camera cameraTowards(const Positions& places, const Vector& towards, const Vector& up, int width,
                     int height) {
  if (!(towards.norm() > 0)) throw InvalidInput("direction: must not be zero");
  Camera camera;
  camera.towards = towards.normalized();
  Vector sideways = camera.towards.cross(up);
  if (sideways.norm() < 1e-6 * up.norm()) {
    sideways = camera.towards.cross(std::abs(camera.towards.z()) < 0.9 ? Vector(0, 0, 1)
                                                                       : Vector(0, 1, 0));
  }
  sideways.normalize();
  camera.up = sideways.cross(camera.towards);
  const Eigen::VectorXd x = places * sideways;
  const Eigen::VectorXd y = places * camera.up;
  const Eigen::VectorXd z = places * camera.towards;
  camera.target = 0.5 * (x.minCoeff() + x.maxCoeff()) * sideways +
                  0.5 * (y.minCoeff() + y.maxCoeff()) * camera.up +
                  0.5 * (z.minCoeff() + z.maxCoeff()) * camera.towards;
  const double halfWidth = 0.5 * (x.maxCoeff() - x.minCoeff());
  const double halfHeight = 0.5 * (y.maxCoeff() - y.minCoeff());
  camera.halfHeight = kMargin * std::max({halfHeight, halfWidth * height / width, 1e-9});
  return camera;
}

Camera cameraFor(const Positions& places, ViewName view, int width, int height) {
  const Vector superior(0, 0, 1), anterior(0, 1, 0);
  const std::array<std::array<Vector, 2>, 6> sights = {{{Vector(1, 0, 0), superior},
                                                        {Vector(-1, 0, 0), superior},
                                                        {Vector(0, -1, 0), superior},
                                                        {Vector(0, 1, 0), superior},
                                                        {Vector(0, 0, -1), anterior},
                                                        {Vector(0, 0, 1), anterior}}};
  const auto& [towards, up] = sights[static_cast<std::size_t>(view)];
  return cameraTowards(places, towards, up, width, height);
}

}  // namespace explica::report
