// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "BoxLanes.h"
#include "Explica/Core/TriangleMesh.h"
#include "MoveTogether.h"

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace explica::surface {

/// The faces at a vertex: few, so that they lie beside their count and not elsewhere in memory.
class FaceRing {
 public:
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] const std::int32_t* begin() const {
    return many_.empty() ? few_.data() : many_.data();
  }
  [[nodiscard]] const std::int32_t* end() const { return begin() + count_; }
  [[nodiscard]] std::int32_t operator[](std::size_t k) const { return begin()[k]; }
  void add(std::int32_t face);
  void remove(std::int32_t face);

 private:
  std::uint32_t count_ = 0;
  std::array<std::int32_t, 9> few_ = {};  ///< all of them, unless `many_` holds them
  std::vector<std::int32_t> many_;
};

/// A triangle mesh that changes by small steps and cannot intersect itself.  It is closed, or has
/// rims, which then stay where they are but for what is said at each step.
///
/// Each step (moving a vertex, collapsing, flipping or splitting an edge) is refused if it would
/// change the topology, or if one of the faces that it makes would meet another face apart from a
/// common vertex or edge, as decided by exact predicates.  So a mesh that starts without
/// self-intersection never has one.  Positions are float32 numbers, as files hold them, so that
/// what is checked is what is written.  Faces are found through a lattice of cells in space.
class GuardedMesh {
 public:
  using Corners = std::array<std::int32_t, 3>;

  /// @param mesh  manifold without self-intersection (not checked)
  /// @param cell  edge of the search cells, mm; about the length of an edge.  Made longer where
  ///              that would give many more cells than faces
  GuardedMesh(const TriangleMesh& mesh, double cell);

  [[nodiscard]] std::int32_t vertexSlots() const {
    return static_cast<std::int32_t>(positions_.size());
  }
  [[nodiscard]] std::int32_t faceSlots() const { return static_cast<std::int32_t>(faces_.size()); }
  [[nodiscard]] std::int64_t faceCount() const { return faceCount_ + scratch_.facesAdded; }
  [[nodiscard]] bool hasVertex(std::int32_t v) const { return !vertexFaces_[v].empty(); }
  [[nodiscard]] bool hasFace(std::int32_t f) const { return faces_[f][0] >= 0; }
  [[nodiscard]] const Point& at(std::int32_t v) const { return positions_[v]; }
  [[nodiscard]] const Corners& face(std::int32_t f) const { return faces_[f]; }
  [[nodiscard]] const FaceRing& facesOf(std::int32_t v) const { return vertexFaces_[v]; }
  [[nodiscard]] std::size_t valence(std::int32_t v) const { return vertexFaces_[v].size(); }
  /// (b - a) x (c - a).
  [[nodiscard]] Vector normalOf(std::int32_t f) const;
  /// The corner that faces the directed edge (a, b) from its left side, or -1.
  [[nodiscard]] std::int32_t opposite(std::int32_t a, std::int32_t b) const;
  [[nodiscard]] bool areJoined(std::int32_t a, std::int32_t b) const;
  /// True if the mesh has a rim.
  [[nodiscard]] bool isOpen() const { return open_; }
  /// True if a face ends at v and there is none beyond.
  [[nodiscard]] bool onRim(std::int32_t v) const { return open_ && endsAt(v); }
  /// The vertices before and after v on the rim; -1 if it does not lie there.
  [[nodiscard]] std::array<std::int32_t, 2> rimNeighbours(std::int32_t v) const;

  /// A vertex among its neighbours.
  struct Ring {
    Point centre = Point::Zero();    ///< area-weighted mean of the faces' centroids
    Point mean = Point::Zero();      ///< of the neighbours
    Vector normal = Vector::Zero();  ///< area-weighted, of unit length; zero if there is none
  };
  [[nodiscard]] Ring ringOf(std::int32_t v) const;
  /// Half way from a vertex of the rim to the middle of its neighbours there.
  [[nodiscard]] Point alongRim(std::int32_t v) const;

  /// Moves a vertex.
  bool move(std::int32_t v, const Point& to);
  /// One thread's notes while it works on its own slab of space.
  struct Scratch {
    std::vector<std::uint32_t> stamp;  ///< per face: query that met it last
    std::uint32_t query = 0;
    std::vector<std::uint32_t> cells;                   ///< of that query
    std::vector<std::int32_t> near;                     ///< faces that it has found
    std::vector<std::int32_t> freeFaces, freeVertices;  ///< left by what it joined
    std::int64_t facesAdded = 0;
    int axis = 0;     ///< across the slabs
    int lowCell = 0;  ///< cells that it may touch
    int highCell = std::numeric_limits<int>::max();
    bool leftZone = false;  ///< a move was refused because it would touch others
  };
  /// That of work on the whole mesh, outside of sweeps.
  [[nodiscard]] Scratch& scratch() {
    bringUpToDate();
    return scratch_;
  }
  /// As move(), within the zone of `scratch`.
  bool move(std::int32_t v, const Point& to, Scratch& scratch);

  /// Calls step(v, scratch) once for each vertex; the step may read the faces at v and move v, and
  /// returns false if it was refused.  Space is cut into slabs that are worked on by several
  /// threads, every other one at a time; vertices whose faces reach too far follow at the end.  The
  /// outcome does not depend on the number of threads.
  void sweep(const std::function<bool(std::int32_t v, Scratch& scratch)>& step);
  /// As above, for some vertices only.
  void sweep(const std::vector<std::int32_t>& vertices,
             const std::function<bool(std::int32_t v, Scratch& scratch)>& step);

  /// Moves vertices all at once, as the function of that name.
  void moveTogether(const std::vector<std::int32_t>& vertices, int attempts, const Attempts& to);
  [[nodiscard]] std::vector<std::int32_t> allVertices() const;

  /// An edge of the mesh, to be worked on.
  using Edge = std::array<std::int32_t, 2>;
  /// Calls step(edge, scratch) once for each of the edges, those of one slab in their order; the
  /// step may collapse or flip the edge.  Threads and outcome as with sweep().
  void sweepEdges(const std::vector<Edge>& edges,
                  const std::function<void(const Edge& edge, Scratch& scratch)>& step);

  /// What a collapse must keep.
  struct CollapseLimits {
    double longestEdge = 0;      ///< no new edge may be longer, mm
    double leastCosine = 0.2;    ///< between a face's normals before and after
    double leastQuality = 0.15;  ///< 4 sqrt(3) area / sum of squared edges of new faces
    double leastArea = 0;        ///< new faces below it must be larger than they were, mm^2
  };
  /// Joins u to v, which goes to `to`; to the rim's vertex if one of the two lies on it.
  bool collapse(std::int32_t u, std::int32_t v, const Point& to, const CollapseLimits& limits);
  bool collapse(std::int32_t u, std::int32_t v, const Point& to, const CollapseLimits& limits,
                Scratch& scratch);
  /// True if collapse() would not be refused.
  [[nodiscard]] bool mayCollapse(std::int32_t u, std::int32_t v, const Point& to,
                                 const CollapseLimits& limits);
  /// Replaces edge (a, b) by the one between the corners that face it.
  bool flip(std::int32_t a, std::int32_t b);
  bool flip(std::int32_t a, std::int32_t b, Scratch& scratch);
  /// Puts a vertex at the middle of edge (a, b), which may be one of the rim.
  /// @return the vertex, or -1 if refused
  std::int32_t split(std::int32_t a, std::int32_t b);
  /// True if split() would not be refused.
  [[nodiscard]] bool maySplit(std::int32_t a, std::int32_t b);

  /// The mesh, vertices and faces in the order of their slots.
  [[nodiscard]] TriangleMesh toMesh() const;

 private:
  struct Placed {
    Corners corners;
    std::array<Point, 3> points;
    Box box;
    Vector normal;     ///< (b - a) x (c - a)
    double magnitude;  ///< that its rounding is relative to
    /// 1 or -1 on the two sides of the face's plane, 0 where rounding leaves it open.
    [[nodiscard]] int sideOf(const Point& p) const;
  };
  /// Faces as their cells know them: most are told apart by boxes, without a look elsewhere.
  struct Entries {
    BoxLanes boxes;
    std::array<std::int32_t, BoxLanes::kLanes> face = {-1, -1, -1, -1};
  };
  /// The faces of a cell: in the common store as long as they have room there, else on their own.
  struct Cell {
    Entries* begin = nullptr;
    std::uint32_t count = 0;  ///< of faces
    std::uint32_t room = 0;   ///< for so many times four of them
    std::unique_ptr<Entries[]> own;
    [[nodiscard]] Entries* end() const {
      return begin + (count + BoxLanes::kLanes - 1) / BoxLanes::kLanes;
    }
    void add(std::int32_t face, const Box& box);
    void remove(std::int32_t face);
    void change(std::int32_t face, const Box& box);
  };
  static constexpr std::size_t kMostFaces = 64;  ///< made by one step: more are refused
  /// A step that was found to be allowed, and what it replaces.
  struct Step {
    std::array<std::int32_t, 2 * kMostFaces> removed;
    std::array<Placed, kMostFaces> made;
    std::size_t removedCount = 0, madeCount = 0;
    Point to;  ///< of the vertex that is moved or made
  };
  using CellRange = std::array<int, 6>;
  /// True if a face made meets another one where it may not.
  [[nodiscard]] static bool facesMeet(const Placed& made, const Corners& corners,
                                      const std::array<Point, 3>& points);

  [[nodiscard]] Placed place(const Corners& corners, std::int32_t moved, const Point& to) const;
  /// True if the faces made meet nothing but what they may; `removed` are left out of account.
  bool admissible(std::span<const Placed> made, std::span<const std::int32_t> removed,
                  Scratch& scratch) const;
  /// Faces whose boxes meet a box, each once and but for those stamped by the query, in
  /// scratch.near.
  void facesNear(const CellRange& range, const Box& box, Scratch& scratch) const;
  /// True if the faces at v do not close: then two neighbours are in one of them only.
  [[nodiscard]] bool endsAt(std::int32_t v) const;
  /// True if joining two vertices leaves a manifold of the same topology.
  [[nodiscard]] bool keepsTopology(std::int32_t u, std::int32_t v) const;
  /// What a collapse would do; false if it is refused.
  bool plan(std::int32_t u, std::int32_t v, const Point& to, const CollapseLimits& limits,
            Scratch& scratch, Step& step) const;
  /// What a split of edge (a, b) at vertex m would do; false if it is refused.
  bool planSplit(std::int32_t a, std::int32_t b, std::int32_t m, Step& step);
  /// Takes a step's faces out and puts its new ones in.
  void replaceFaces(const Step& step, Scratch& scratch);
  /// The box of three points, wider than their rounding to float.
  [[nodiscard]] Box boxOf(const std::array<Point, 3>& points) const;
  [[nodiscard]] int cellAt(double coordinate, int axis) const;
  [[nodiscard]] CellRange cellsOf(const Box& box) const;
  template <class Visit>
  void forCells(const CellRange& range, const Visit& visit) const;
  /// True if every face at v lies within the zone.
  [[nodiscard]] bool inZone(std::int32_t v, const Scratch& scratch) const;
  void placeCells(const Point& low, const Point& high, double cell, Eigen::Index faces);
  /// Gives every cell its part of the common store, with room for more.
  void fillCells();
  [[nodiscard]] Box roomy(const Box& box) const;
  void enter(std::int32_t f);
  void enter(std::int32_t f, const CellRange& range);
  class FacesOfSlabs;
  void leave(std::int32_t f);
  void rebox(std::int32_t f, const Box& box);
  /// Fills the cells if they are needed the first time, or after vertices have moved together.
  void bringUpToDate();
  void reboxAll();
  /// The faces there are; vertices keep their numbers, those without faces too.
  [[nodiscard]] TriangleMesh withAllSlots() const;
  std::int32_t addFace(const Corners& corners, Scratch& scratch);
  void removeFace(std::int32_t f, Scratch& scratch);
  /// Calls work(item, scratch) for each item, by slabs of space along the longest side of the mesh;
  /// zones of slabs worked on together touch, but do not overlap.  What returns false, as it
  /// reaches beyond its zone, is asked again at the end.
  /// @param placeOf  coordinate of an item along an axis
  template <class Item, class PlaceOf, class Work>
  void overSlabs(const std::vector<Item>& items, const PlaceOf& placeOf, const Work& work);

  std::vector<Point> positions_;
  std::vector<Corners> faces_;
  std::vector<Box> boxes_;  ///< as the cells have them: a little wider than the faces
  std::vector<FaceRing> vertexFaces_;
  std::int64_t faceCount_ = 0;  ///< at the start
  bool open_ = false;
  Point cellOrigin_ = Point::Zero();
  double cellsPerMm_ = 1;
  double roomOfBoxes_ = 0;  ///< mm
  float slack_ = 0;         ///< mm that a face may move before its cells are told
  std::array<int, 3> cellSize_ = {1, 1, 1};
  std::vector<Entries> store_;
  std::vector<Cell> cells_;
  std::vector<std::uint64_t> occupied_;  ///< a bit a cell: 0 where there never was a face
  bool filled_ = false, stale_ = false;  ///< the cells: at all, as the vertices are no more
  Scratch scratch_;
  std::vector<Scratch> slabScratch_;
};

}  // namespace explica::surface
